// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/staged_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/log.h"
#include "formats/atomic_file.h"
#include "formats/folder_lock.h"
#include "formats/make_folder.h"
#include "formats/refusal.h"
#include "formats/resolved_place.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

std::unexpected<Error> storage(const fs::path& path, std::string_view doing, int why) {
  return refused(path, doing, why, "choose another folder");
}
std::unexpected<Error> storage(const fs::path& path, std::string_view doing, const std::error_code& why) {
  return storage(path, doing, why.value());
}

bool is_free(const fs::path& target) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(target, ignored);
  return !fs::exists(status) || (fs::is_directory(status) && fs::is_empty(target, ignored));
}

/// Where what is replaced steps aside. One that lies there was left by a program that was killed, maybe
/// before the new one was in its place: it stays.
fs::path free_name_of_replaced(const fs::path& target) {
  const std::string name = target.filename().string() + ".replaced";
  fs::path aside = target.parent_path() / name;
  for (int k = 2; !is_free(aside); ++k) {
    aside = target.parent_path() / (name + "-" + std::to_string(k));
  }
  return aside;
}

/// Of a folder that was there before: whoever else made it, or may write into it, could go on doing so in
/// what is made of it.
bool is_open_to_others(const struct stat& folder) {
  return folder.st_uid != ::geteuid() || (folder.st_mode & S_IWOTH) != 0;
}

/// The top of a mounted disk, or of a part of one that is mounted elsewhere too.
bool is_mount_point(const fs::path& folder) {
  struct statx own {};
  if (::statx(AT_FDCWD, folder.c_str(), AT_SYMLINK_NOFOLLOW, STATX_INO, &own) != 0) {
    return false;
  }
  if ((own.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0) {
    return (own.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
  }
  struct stat here {};  // Linux before 5.8
  struct stat above {};
  return ::lstat(folder.c_str(), &here) == 0 && ::stat(folder.parent_path().c_str(), &above) == 0 &&
         here.st_dev != above.st_dev;
}

}  // namespace

Status check_no_disk_is_mounted_at(const fs::path& wanted) {
  const fs::path target = resolved_place(wanted);
  return is_mount_point(target)
             ? fail(ErrorKind::kUsage, "this is the top of a disk, and a folder cannot take its place",
                    target.string(), "give a folder in it, such as " + (target / "package").string())
             : Status();
}

Result<StagedFolder> StagedFolder::begin(const fs::path& wanted, bool replace) {
  std::error_code error;
  if (const Status place = check_no_disk_is_mounted_at(wanted); !place) {
    return std::unexpected(place.error());
  }
  fs::path target = resolved_place(wanted);
  if (!replace && !is_free(target)) {
    return fail(ErrorKind::kUsage, "something lies there already", target.string(),
                "choose another folder, or replace it with --force");
  }
  if (Status made = make_folder(target.parent_path()); !made) {
    return std::unexpected(std::move(made.error()));
  }
  const fs::path staged = target.parent_path() / (std::string(kTemporaryPrefix) + target.filename().string());
  for (int attempt = 0; attempt < 2; ++attempt) {
    const bool made = fs::create_directory(staged, error);
    if (error) {
      return storage(target, "cannot make the folder", error);
    }
    const int lock = ::open(staged.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (lock < 0) {
      continue;  // taken away between the two steps
    }
    struct stat mine {};
    struct stat there {};
    if (const int why = lock_folder(lock, LOCK_EX | LOCK_NB); why != 0) {
      ::close(lock);
      return why != EWOULDBLOCK ? storage(staged, "cannot lock the folder", why)
                                : fail(ErrorKind::kStorage, "another program is writing this folder now",
                                       target.string(), "wait for it, or choose another folder");
    }
    if (::fstat(lock, &mine) == 0 && ::stat(staged.c_str(), &there) == 0 && mine.st_ino == there.st_ino) {
      if (!made && is_open_to_others(mine)) {
        ::close(lock);
        fs::remove_all(staged, error);
        if (error) {
          return storage(staged, "others may write into it, and it cannot be taken away", error);
        }
        continue;  // made anew
      }
      for (fs::directory_iterator it(staged, error), end; !made && !error && it != end; it.increment(error)) {
        fs::remove_all(it->path(), error);
        if (error) {
          break;  // going on to the next would forget it
        }
      }
      if (error) {
        ::close(lock);
        return storage(staged, "cannot clear what was left there", error);
      }
      return StagedFolder(std::move(target), staged, lock, replace);
    }
    ::close(lock);
  }
  return fail(ErrorKind::kStorage, "cannot make the folder: others take it away or put theirs there",
              staged.string(), "choose another folder");
}

StagedFolder::StagedFolder(StagedFolder&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::exchange(other.path_, {})),
      lock_(std::exchange(other.lock_, -1)),
      replaces_(other.replaces_) {}

StagedFolder::~StagedFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  if (lock_ >= 0) {
    ::close(lock_);
  }
}

Status StagedFolder::publish() {
  std::error_code error;
  for (fs::recursive_directory_iterator it(path_, error), end; !error && it != end; it.increment(error)) {
    if (it->is_directory()) {
      if (const Status synced = sync_folder(it->path()); !synced) {
        return synced;
      }
    }
  }
  if (error) {
    return storage(path_, "cannot read back what was written", error);
  }
  if (const Status synced = sync_folder(path_); !synced) {
    return synced;
  }
  // rename() replaces an empty folder by itself, and nothing else: not what came there meanwhile.
  if (!replaces_ || is_free(target_)) {
    if (::rename(path_.c_str(), target_.c_str()) != 0) {
      const int why = errno;
      return why == ENOTEMPTY || why == EEXIST || why == ENOTDIR
                 ? fail(ErrorKind::kUsage, "somebody has put something there since this was begun",
                        target_.string(), "choose another folder, or remove it yourself")
                 : storage(target_, "cannot put the folder in its place", why);
    }
    path_.clear();
    return sync_folder(target_.parent_path());
  }
  const auto exchange = [&] {
    return ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0;
  };
  const bool exchanged = exchange();
  if (!exchanged) {
    // A file system that cannot exchange: the old one steps aside under a name that says what it is.
    const fs::path aside = free_name_of_replaced(target_);
    if (::rename(target_.c_str(), aside.c_str()) != 0) {
      return storage(aside, "cannot move the old folder there", errno);
    }
    if (::rename(path_.c_str(), target_.c_str()) != 0) {
      const int why = errno;
      (void)::rename(aside.c_str(), target_.c_str());
      return storage(target_, "cannot put the folder in its place", why);
    }
    path_ = aside;
  }
  if (const Status synced = sync_folder(target_.parent_path()); !synced) {
    if (!exchanged || !exchange()) {
      path_.clear();  // what was there before stays beside it
    }
    return synced;
  }
  fs::remove_all(path_, error);
  if (error) {
    log_warning(fmt::format("{}: what was replaced cannot be taken away: {}; it is needed no more",
                            path_.string(), error.message()));
  }
  path_.clear();
  return {};
}

}  // namespace dubsar
