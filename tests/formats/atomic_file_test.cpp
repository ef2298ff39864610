// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/atomic_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>

#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::ScratchFolder;

/// Lets no file grow past `bytes` while it lives: a full disk that a test can have.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(AtomicFile, WritesAndReplaces) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "a", "first"));
  ASSERT_TRUE(write_file_atomically(folder / "a", std::string_view("second\0x", 8)));
  EXPECT_EQ(read_whole_file(folder / "a").value(), std::string("second\0x", 8));
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(AtomicFile, LetsNobodyReadTheNewFileWhoMightNotReadTheOldOne) {
  const ScratchFolder folder;
  const auto rights = [&] {
    struct stat file {};
    EXPECT_EQ(::stat((folder / "a").c_str(), &file), 0);
    return file.st_mode & 0777U;
  };
  const mode_t before = ::umask(022);
  EXPECT_TRUE(write_file_atomically(folder / "a", "first"));
  EXPECT_EQ(rights(), 0644U);
  for (const auto& [was, is] : {std::pair<mode_t, mode_t>{0600, 0600}, {0664, 0664}, {0440, 0640}}) {
    ::chmod((folder / "a").c_str(), was);
    EXPECT_TRUE(write_file_atomically(folder / "a", "again"));
    EXPECT_EQ(rights(), is);
  }
  ::umask(before);
}

TEST(AtomicFile, ALinkStaysWhereThatIsAskedFor) {
  const ScratchFolder folder;
  ASSERT_TRUE(std::filesystem::create_directory(folder / "shared"));
  ASSERT_TRUE(write_file_atomically(folder / "shared/a", "old"));
  std::filesystem::create_symlink("shared/a", folder / "link");
  std::filesystem::create_symlink("nothing", folder / "dangling");
  ASSERT_TRUE(write_behind_link(folder / "link", "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_whole_file(folder / "shared/a").value(), "new");
  for (const char* name : {"dangling", "plain"}) {
    ASSERT_TRUE(write_behind_link(folder / name, "new")) << name;
    EXPECT_EQ(read_whole_file(folder / name).value(), "new") << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "nothing"));
  // Elsewhere it is replaced: what is stored in a session lies in the session.
  ASSERT_TRUE(write_file_atomically(folder / "link", "newer"));
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_whole_file(folder / "shared/a").value(), "new");
}

TEST(AtomicFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "a", "old"));
  const std::string big(200000, 'x');
  Status status;
  {
    const FileSizeLimit limit(100000);
    status = write_file_atomically(folder / "a", big);
  }
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kStorage);
  EXPECT_THAT(line_of(status), HasSubstr("cannot write: File too large"));
  EXPECT_EQ(read_whole_file(folder / "a").value(), "old");
  EXPECT_EQ(folder.file_count(), 1U) << "a temporary file stayed behind";
}

TEST(AtomicFile, KeepsTheOldFileWhenTheProducerFails) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "a", "old"));
  const Status status = write_file_atomically(folder / "a", [](const ByteSink& sink) -> Status {
    const std::string part = "part";
    if (Status written = sink(std::as_bytes(std::span(part))); !written) {
      return written;
    }
    return fail(ErrorKind::kCancelled, "stopped");
  });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(read_whole_file(folder / "a").value(), "old");
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(AtomicFile, SaysWhenTheDeviceIsFullAndLeavesItADevice) {
  if (::access("/dev/full", W_OK) != 0) {
    GTEST_SKIP() << "no /dev/full here";
  }
  const Status status = write_file_atomically("/dev/full", "some bytes");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kStorage);
  EXPECT_THAT(line_of(status), HasSubstr("No space left on device; free some space"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

/// Opening it would wait for a reader, whatever signal comes.
TEST(AtomicFile, APipeThatNobodyReadsIsRefusedAndASocketToo) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = (folder / "socket").string();
  ASSERT_LT(name.size(), sizeof address.sun_path);
  name.copy(address.sun_path, name.size());
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  for (const char* file : {"pipe", "socket"}) {
    const Status status = write_file_atomically(folder / file, "some bytes");
    ASSERT_FALSE(status) << file;
    EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(line_of(status),
                HasSubstr("cannot write: a pipe that nobody reads from, or a socket; start"));
  }
  ::close(listener);
}

TEST(AtomicFile, APipeThatIsReadGetsAllHoweverSlowly) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const std::string big(1000000, 'x');  // more than a pipe holds
  std::size_t got = 0;
  std::atomic<bool> written = false;
  std::thread slow([&] {
    std::string some(4096, ' ');
    // A write that failed leaves less in it.
    for (bool last = false; got < big.size() && !last;) {
      last = written;
      const ssize_t read = ::read(reader, some.data(), some.size());
      got += static_cast<std::size_t>(std::max<ssize_t>(read, 0));
      last = last && read <= 0;
    }
  });
  const Status status = write_file_atomically(folder / "pipe", big);
  written = true;
  slow.join();
  EXPECT_TRUE(status) << line_of(status);
  EXPECT_EQ(got, big.size());
  ::close(reader);
}

TEST(AtomicFile, ASignalEndsTheWaitForWhoDoesNotRead) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const auto before = std::signal(SIGALRM, [](int) {});  // as the command does: calls go on after it
  const itimerval again{{0, 10000}, {0, 10000}};
  ::setitimer(ITIMER_REAL, &again, nullptr);
  const Status status = write_file_atomically(folder / "pipe", std::string(1000000, 'x'));
  const itimerval never{};
  ::setitimer(ITIMER_REAL, &never, nullptr);
  std::signal(SIGALRM, before);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kCancelled);
  ::close(reader);
}

TEST(AtomicFile, RefusesAReadOnlyFolder) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "the superuser may write anywhere";
  }
  const ScratchFolder folder;
  ::chmod(folder.path().c_str(), 0555);
  const Status status = write_file_atomically(folder / "a", "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kStorage);
  EXPECT_THAT(line_of(status), HasSubstr("choose a folder that can be written to"));
}

TEST(AtomicFile, NamesAMissingFolder) {
  const ScratchFolder folder;
  const Status status = write_file_atomically(folder / "no/such/file", "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kStorage);
  EXPECT_THAT(line_of(status), HasSubstr("make the folder first"));
}

TEST(AtomicFile, RefusesToReplaceAFolder) {
  const ScratchFolder folder;
  const Status status = write_file_atomically(folder.path(), "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kUsage);  // not the disk's: to try again is of no use
  EXPECT_THAT(line_of(status), HasSubstr("name a file, not a folder"));
}

TEST(ReadWholeFile, ErrorsNameTheFile) {
  const ScratchFolder folder;
  EXPECT_THAT(line_of(read_whole_file(folder / "none")), HasSubstr("none: cannot read: No such file"));
  EXPECT_THAT(line_of(read_whole_file(folder.path())), HasSubstr("not a file"));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);  // opening it would wait for a writer
  EXPECT_THAT(line_of(read_whole_file(folder / "pipe")), HasSubstr("not a file"));
  ASSERT_TRUE(write_file_atomically(folder / "a", "12345"));
  EXPECT_THAT(line_of(read_whole_file(folder / "a", 4)), HasSubstr("holds 5 bytes, more than the 4"));
  EXPECT_EQ(read_file_head(folder / "a", 3).value(), "123");
}

}  // namespace
}  // namespace dubsar
