// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/wait.h>
#include <unistd.h>

namespace dubsar::test {

/// Runs body in a child process and returns its exit status.
template <class Body>
int in_child(const Body& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(body());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// In a child process from here on: whom rights bind. Root may go anywhere; nobody may not.
[[nodiscard]] inline bool be_bound_by_rights() {
  constexpr uid_t kNobody = 65534;
  return ::getuid() != 0 || ::setuid(kNobody) == 0;
}

}  // namespace dubsar::test
