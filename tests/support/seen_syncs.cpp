// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/support/seen_syncs.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <mutex>
#include <set>
#include <utility>

namespace {

std::mutex mutex;  // rows of scans are written by threads of their own
std::set<std::pair<dev_t, ino_t>> synced;

}  // namespace

// In the place of the C library's.
extern "C" int fsync(int file) {
  struct stat info {};
  if (::fstat(file, &info) == 0) {
    const std::scoped_lock lock(mutex);
    synced.emplace(info.st_dev, info.st_ino);
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace dubsar::test {

void forget_syncs() {
  const std::scoped_lock lock(mutex);
  synced.clear();
}

bool was_synced(const std::filesystem::path& path) {
  struct stat info {};
  const std::scoped_lock lock(mutex);
  return ::stat(path.c_str(), &info) == 0 && synced.contains({info.st_dev, info.st_ino});
}

}  // namespace dubsar::test
