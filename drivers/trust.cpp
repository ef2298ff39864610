// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/trust.h"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace dubsar {

namespace fs = std::filesystem;

namespace {

std::unexpected<Error> distrusted(const fs::path& file, const fs::path& place, const std::string& why,
                                  const std::string& mend) {
  const std::string what = place == file ? "it" : place.string();
  return fail(ErrorKind::kDevice, why + " " + what, file.string(), "skipped; " + mend);
}

/// The group that many systems give each user, with nobody else in it.
bool is_private_group(gid_t group, uid_t user) {
  char group_text[4096];
  char user_text[4096];
  struct group entry {};
  struct passwd person {};
  struct group* found_group = nullptr;
  struct passwd* found_user = nullptr;
  if (::getgrgid_r(group, &entry, group_text, sizeof group_text, &found_group) != 0 ||
      ::getpwuid_r(user, &person, user_text, sizeof user_text, &found_user) != 0 || found_group == nullptr ||
      found_user == nullptr) {
    return false;
  }
  return person.pw_gid == group && std::strcmp(entry.gr_name, person.pw_name) == 0 &&
         (entry.gr_mem == nullptr || entry.gr_mem[0] == nullptr);
}

}  // namespace

Result<fs::path> trusted_file(const fs::path& file, uid_t user) {
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error) {
    return fail(ErrorKind::kDevice, "cannot be looked at: " + error.message(), file.string(), "skipped");
  }
  fs::path place = real;
  for (int level = 0;; ++level, place = place.parent_path()) {
    const bool above = level >= 2;  // neither the file nor its folder
    struct stat info {};
    if (::lstat(place.c_str(), &info) != 0) {
      return fail(ErrorKind::kDevice, std::string("cannot be looked at: ") + std::strerror(errno),
                  file.string(), "skipped");
    }
    if (level == 0 && !S_ISREG(info.st_mode)) {
      return fail(ErrorKind::kDevice, "not a file", file.string(), "skipped");
    }
    if (info.st_uid != 0 && info.st_uid != user) {
      return distrusted(real, place, "another user (" + std::to_string(info.st_uid) + ") owns",
                        "have its owner changed (chown) and see who wrote it");
    }
    const bool sticky = above && (info.st_mode & S_ISVTX) != 0;
    if ((info.st_mode & S_IWOTH) != 0 && !sticky) {
      return distrusted(real, place, "everybody may write to",
                        "take the right away (chmod o-w) and see who wrote it");
    }
    if (!above && (info.st_mode & S_IWGRP) != 0 && info.st_gid != 0 && !is_private_group(info.st_gid, user)) {
      return distrusted(real, place, "a group (" + std::to_string(info.st_gid) + ") may write to",
                        "take the right away (chmod g-w) and see who wrote it");
    }
    if (place == place.parent_path()) {
      return real;
    }
  }
}

}  // namespace dubsar
