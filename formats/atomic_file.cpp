// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/atomic_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include "formats/refusal.h"
#include "formats/stoppable_read.h"

namespace dubsar {

namespace {

/// An open file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { (void)close_now(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return fd_; }
  /// False when the system reports a late write error.
  [[nodiscard]] bool close_now() {
    const int fd = std::exchange(fd_, -1);
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

/// Removes the temporary file unless it was renamed.
class Unlinker {
 public:
  explicit Unlinker(std::string path) : path_(std::move(path)) {}
  ~Unlinker() {
    if (!path_.empty()) {
      ::unlink(path_.c_str());
    }
  }
  Unlinker(const Unlinker&) = delete;
  Unlinker& operator=(const Unlinker&) = delete;
  void release() { path_.clear(); }

 private:
  std::string path_;
};

constexpr const char* kNameAFile = "name a file, not a folder";

std::unexpected<Error> storage_error(const std::filesystem::path& path, const char* doing, int error) {
  const char* otherwise = error == ENOENT || error == ENOTDIR ? "make the folder first"
                          : error == EISDIR                   ? kNameAFile
                                                              : "check the disk";
  return refused(path, doing, error, otherwise);
}

/// Of a pipe that is full: until somebody reads from it, or a signal wants the program to stop. A wait for
/// room is never taken up again after a signal, as a write may be: who does not read would keep the program.
Status wait_for_room(int fd, const std::filesystem::path& path) {
  pollfd room{fd, POLLOUT, 0};
  return ::poll(&room, 1, -1) < 0 && errno == EINTR
             ? fail(ErrorKind::kCancelled, "writing was stopped", path.string())
             : Status();
}

Status write_all(int fd, const std::filesystem::path& path, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    // Linux writes at most 2 GiB at a time.
    const ssize_t written = ::write(fd, bytes.data(), std::min<std::size_t>(bytes.size(), 1U << 30U));
    if (written < 0) {
      if (errno == EINTR) {
        continue;
      }
      if (errno != EAGAIN) {
        return storage_error(path, "cannot write", errno);
      }
      if (const Status room = wait_for_room(fd, path); !room) {
        return room;
      }
      continue;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

/// Nothing waits in here but wait_for_room(): not the opening of a pipe, for somebody who reads from it.
Status write_to_device(const std::filesystem::path& path, const ByteProducer& produce) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0 && errno == ENXIO) {
    return fail(ErrorKind::kUsage, "cannot write: a pipe that nobody reads from, or a socket", path.string(),
                "start what reads it first, or name a file");
  }
  if (file.get() < 0) {
    return storage_error(path, "cannot open", errno);
  }
  return produce([&](std::span<const std::byte> bytes) { return write_all(file.get(), path, bytes); });
}

std::filesystem::path temporary_beside(const std::filesystem::path& folder) {
  static std::atomic<unsigned> counter{0};
  return folder / (std::string(kTemporaryPrefix) + std::to_string(::getpid()) + "-" +
                   std::to_string(counter.fetch_add(1)));
}

}  // namespace

Status write_file_atomically(const std::filesystem::path& path, const ByteProducer& produce) {
  struct stat existing {};
  const bool exists = ::stat(path.c_str(), &existing) == 0;
  if (exists && !S_ISREG(existing.st_mode)) {
    // Wrong words, no disk that refuses: to do it again is of no use.
    return S_ISDIR(existing.st_mode)
               ? Status(fail(ErrorKind::kUsage, "cannot write: it is a folder", path.string(), kNameAFile))
               : write_to_device(path, produce);
  }
  const std::filesystem::path folder = folder_of(path);
  std::filesystem::path temporary;
  int fd = -1;
  do {
    temporary = temporary_beside(folder);
    fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (fd < 0 && (errno == EEXIST || errno == EINTR));
  if (fd < 0) {
    return storage_error(path, "cannot make a file here", errno);
  }
  Descriptor file(fd);
  Unlinker unlinker(temporary.string());
  if (exists) {
    // Some file systems have no such rights, and refuse. Who writes it may do so again.
    [[maybe_unused]] const int kept = ::fchmod(file.get(), (existing.st_mode & 0777U) | S_IWUSR);
  }
  if (Status done =
          produce([&](std::span<const std::byte> bytes) { return write_all(file.get(), path, bytes); });
      !done) {
    return done;
  }
  if (::fsync(file.get()) != 0) {
    return storage_error(path, "cannot sync", errno);
  }
  if (!file.close_now()) {
    return storage_error(path, "cannot close", errno);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    return storage_error(path, "cannot put the new file in its place", errno);
  }
  unlinker.release();
  return sync_folder(folder);
}

Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return write_file_atomically(path, [&](const ByteSink& sink) { return sink(bytes); });
}

Status write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

Status write_behind_link(const std::filesystem::path& path, std::string_view text) {
  std::error_code nowhere;
  const std::filesystem::path file =
      std::filesystem::is_symlink(path, nowhere) ? std::filesystem::canonical(path, nowhere) : path;
  return write_file_atomically(file.empty() ? path : file, text);
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

Status sync_folder(const std::filesystem::path& folder) {
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // EINVAL: it cannot, and what was done is as durable as it gets.
  if (directory.get() < 0 || (::fsync(directory.get()) != 0 && errno != EINVAL)) {
    return storage_error(folder, "cannot sync the folder", errno);
  }
  return {};
}

namespace {

std::unexpected<Error> read_error(const std::filesystem::path& path, int error) {
  if (error == EIO) {
    return fail(ErrorKind::kStorage, "cannot read: the disk reports an error", path.string(),
                "copy the file again from its source");
  }
  return bad_input(path.string(), std::string("cannot read: ") + std::strerror(error),
                   error == EACCES ? "make it readable" : "check the name");
}

/// Between two of them it is asked whether to go on: a slow disk takes a second for one.
constexpr std::size_t kReadBlockBytes = std::size_t{16} << 20U;

/// Reads up to `limit` bytes; a larger file is an error when the whole is asked for.
Result<std::string> read_up_to(const std::filesystem::path& path, std::uint64_t limit, bool whole,
                               const JobContext* job) {
  // What is no file is refused below: opening a pipe would wait for somebody to write into it.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) {
    return read_error(path, errno);
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) {
    return read_error(path, errno);
  }
  if (!S_ISREG(status.st_mode)) {
    return bad_input(path.string(), "not a file", "name a file");
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (whole && size > limit) {
    return bad_input(
        path.string(),
        "holds " + std::to_string(size) + " bytes, more than the " + std::to_string(limit) + " that are read",
        "split it or thin it out");
  }
  std::string bytes;
  int error = 0;
  bytes.resize_and_overwrite(
      static_cast<std::size_t>(std::min(size, limit)), [&](char* into, std::size_t count) {
        std::size_t have = 0;
        while (have < count && (job == nullptr || !job->cancelled())) {
          const std::size_t most = job == nullptr ? count : kReadBlockBytes;
          const ssize_t got = ::read(file.get(), into + have, std::min(count - have, most));
          if (got < 0 && errno == EINTR) {
            continue;
          }
          if (got < 0) {
            error = errno;
          }
          if (got <= 0) {
            break;
          }
          have += static_cast<std::size_t>(got);
        }
        return have;
      });
  if (error != 0) {
    return read_error(path, error);
  }
  if (job != nullptr && job->cancelled()) {
    return fail(ErrorKind::kCancelled, "reading was stopped", path.string());
  }
  return bytes;
}

}  // namespace

Result<std::string> read_whole_file(const std::filesystem::path& path, std::uint64_t limit_bytes) {
  return read_up_to(path, limit_bytes, true, nullptr);
}

Result<std::string> read_whole_file_unless_stopped(const std::filesystem::path& path, const JobContext* job) {
  return read_up_to(path, kMaxFileBytes, true, job);
}

Result<std::ifstream> open_stored_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    return bad_input(path.string(), "not a file", "bring it back from a copy");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return bad_input(path.string(), "missing or unreadable", "bring it back from a copy");
  }
  return file;
}

Result<std::string> read_file_head(const std::filesystem::path& path, std::size_t count) {
  return read_up_to(path, count, false, nullptr);
}

}  // namespace dubsar
