// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/resource.h>

namespace dubsar::bench {

/// The most of this program that was resident so far, GiB.
[[nodiscard]] inline double peak_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

}  // namespace dubsar::bench
