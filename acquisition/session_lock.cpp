// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "acquisition/session_files.h"
#include "formats/atomic_file.h"
#include "formats/refusal.h"

namespace dubsar::session {

namespace fs = std::filesystem;

namespace {

std::unexpected<Error> not_locked(const fs::path& path, int error) {
  return refused(path, "cannot lock the session", error, "choose a folder that can be written to");
}

/// Never through a link: what it leads to would be emptied.
Result<int> open_lock(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (fd < 0 && errno != ELOOP) {
    return not_locked(path, errno);
  }
  struct stat file {};
  if (fd >= 0 && ::fstat(fd, &file) == 0 && S_ISREG(file.st_mode)) {
    return fd;
  }
  if (fd >= 0) {
    ::close(fd);
  }
  return bad_input(path.string(), "a link, or no file: the session is not locked through it",
                   "take it away while no program writes to this session: it holds nothing");
}

bool has_other_names(int fd) {
  struct stat file {};
  return ::fstat(fd, &file) == 0 && file.st_nlink > 1;
}

/// Whether the name still leads to the file: another program may have put a lock of its own there.
bool lies_at(int fd, const fs::path& path) {
  struct stat file {};
  struct stat there {};
  return ::fstat(fd, &file) == 0 && ::lstat(path.c_str(), &there) == 0 && file.st_dev == there.st_dev &&
         file.st_ino == there.st_ino;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_in_name(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '.';
}

std::string this_computer() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) {
    return {};
  }
  return {name.begin(), std::ranges::find_if_not(name, is_in_name)};
}

/// The program that wrote last, for people; empty where that is not known. On a disk that computers share it
/// may run on another, where that number is somebody else's here.
std::string told_writer(int fd) {
  std::array<char, 300> said{};
  if (::pread(fd, said.data(), said.size() - 1, 0) <= 0) {
    return {};
  }
  auto* const after = std::ranges::find_if_not(said, is_digit);
  const std::string process(said.begin(), after);
  std::string computer;
  if (*after == ' ') {
    computer.assign(after + 1, std::find_if_not(after + 1, said.end(), is_in_name));
  }
  const bool is_here = computer.empty() || computer == this_computer();
  return process.empty() ? std::string()
                         : " (process " + process + (is_here ? "" : " of the computer " + computer) + ")";
}

std::unexpected<Error> held(int fd, const fs::path& folder) {
  const std::string what =
      has_other_names(fd) ? "another program is writing to this session, or to one that shares its files "
                            "through hard links"
                          : "another program is writing to this session";
  // It goes away by itself: to do it again is of use, as with a package that another is making.
  return fail(ErrorKind::kStorage, what + told_writer(fd), folder.string(),
              "close it first, or open the session for reading only");
}

}  // namespace

Result<FolderLock> FolderLock::take(const fs::path& folder) {
  const fs::path path = folder / kLock;
  for (;;) {
    const Result<int> opened = open_lock(path);
    if (!opened) {
      return std::unexpected(opened.error());
    }
    FolderLock lock(*opened);
    if (::flock(lock.fd_, LOCK_EX | LOCK_NB) != 0) {
      return errno == EWOULDBLOCK ? held(lock.fd_, folder) : not_locked(path, errno);
    }
    if (!lies_at(lock.fd_, path)) {
      continue;
    }
    if (has_other_names(lock.fd_)) {
      Result<FolderLock> own = put_own(path);
      if (!own) {
        return own;
      }
      std::swap(lock.fd_, own->fd_);
    }
    lock.note_process();
    return lock;
  }
}

Result<FolderLock> FolderLock::put_own(const fs::path& path) {
  const fs::path fresh =
      folder_of(path) / (std::string(kTemporaryPrefix) + "lock-" + std::to_string(::getpid()));
  ::unlink(fresh.c_str());  // of a program that was killed here
  FolderLock own(::open(fresh.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (own.fd_ < 0 || ::flock(own.fd_, LOCK_EX | LOCK_NB) != 0 || ::rename(fresh.c_str(), path.c_str()) != 0) {
    const int why = errno;
    ::unlink(fresh.c_str());
    return not_locked(path, why);
  }
  return own;
}

bool FolderLock::is_of(const fs::path& folder) const {
  return lies_at(fd_, folder / kLock);
}

/// Only for words: the lock itself holds without.
void FolderLock::note_process() const {
  const std::string who = std::to_string(::getpid()) + " " + this_computer() + "\n";
  if (::ftruncate(fd_, 0) == 0) {
    [[maybe_unused]] const ssize_t written = ::pwrite(fd_, who.data(), who.size(), 0);
  }
}

FolderLock::FolderLock(FolderLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}
FolderLock::~FolderLock() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

}  // namespace dubsar::session
