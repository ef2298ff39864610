// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/huge_pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace dubsar {

void wish_for_huge_pages(void* memory, std::size_t bytes) {
  constexpr std::size_t kWorthIt = std::size_t{4} << 20U;
  if (bytes < kWorthIt) {
    return;
  }
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t to_next = page - reinterpret_cast<std::uintptr_t>(memory) % page;
  // Whole pages of it alone.
  madvise(static_cast<char*>(memory) + to_next, (bytes - to_next) / page * page, MADV_HUGEPAGE);
}

}  // namespace dubsar
