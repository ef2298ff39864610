// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/huge_pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

#include "core/parallel.h"

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

void touch_in_parallel(void* memory, std::size_t bytes) {
  constexpr std::size_t kChunk = std::size_t{4} << 20U;
  constexpr std::size_t kSmallestPage = 4096;
  char* const first = static_cast<char*>(memory);
  parallel_chunks(bytes, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; at += kSmallestPage) {
      first[at] = 0;
    }
  });
}

}  // namespace dubsar
