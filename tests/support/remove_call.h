// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace dubsar::test {

/// What the C library's remove() does, for tests that put one of their own in its place.
inline int remove_call(const char* name) {
  const auto unlinked = static_cast<int>(::syscall(SYS_unlink, name));
  return unlinked != 0 && errno == EISDIR ? static_cast<int>(::syscall(SYS_rmdir, name)) : unlinked;
}

}  // namespace dubsar::test
