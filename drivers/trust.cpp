// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/trust.h"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/xattr.h>

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

/// Rights that the mode does not show: with an access list its group bits are the most that anybody named in
/// the list may do.
bool has_access_list(const fs::path& place) {
  return ::lgetxattr(place.c_str(), "system.posix_acl_access", nullptr, 0) > 0;
}

/// Whoever is in it may install programs for everybody: root, and what Debian gives /usr/local to.
bool may_install(gid_t group) {
  char text[4096];
  struct group entry {};
  struct group* found = nullptr;
  return group == 0 || (::getgrgid_r(group, &entry, text, sizeof text, &found) == 0 && found != nullptr &&
                        std::strcmp(entry.gr_name, "staff") == 0);
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
    const bool by_group = (info.st_mode & S_IWGRP) != 0 && !sticky;
    if (by_group && has_access_list(place)) {
      return distrusted(real, place, "by an access list others may write to",
                        "take it away (setfacl -b) and see who wrote it");
    }
    const bool known_group = above ? may_install(info.st_gid) : info.st_gid == 0;
    if (by_group && !known_group && !is_private_group(info.st_gid, user)) {
      return distrusted(real, place, "a group (" + std::to_string(info.st_gid) + ") may write to",
                        "take the right away (chmod g-w) and see who wrote it");
    }
    if (place == place.parent_path()) {
      return real;
    }
  }
}

}  // namespace dubsar
