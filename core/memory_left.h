// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

namespace dubsar {

struct MemoryLeft {
  std::int64_t total_bytes =
      0;  ///< of the machine, or what the program's control group is granted; 0: unknown
  std::int64_t free_bytes = 0;  ///< of it, that can still be had without writing anything to disk first
};

/// What the kernel says: /proc/meminfo, and the limits of the control group (version 1 or 2) that the program
/// runs in and of those around it; the narrowest counts. Takes no memory. `root` stands before the paths.
[[nodiscard]] MemoryLeft memory_left(const char* root = "") noexcept;

}  // namespace dubsar
