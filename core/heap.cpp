// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/heap.h"

#include <cstdlib>  // defines __GLIBC__ where it is

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "core/kept_blocks.h"

namespace dubsar {

namespace {

/// Free at the end of a heap before it goes back to the system. Each thread has a heap, and what lies free at
/// the end of one stays: malloc_trim() gives back the end of the first heap only.
constexpr std::size_t kHeldBytes = std::size_t{4} << 20U;

}  // namespace

void map_large_blocks() {
#if defined(__GLIBC__)
  // Said outright, it also stays: left alone, glibc raises the threshold to the largest block that was let go
  // of.
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(kOwnMappingBytes));
  // That alone would leave the heap's end where it was to be given back at every 128 KiB, however often it is
  // taken again: the graphics driver for a processor did so hundreds of times a second, each time a wait for
  // all cores.
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(kHeldBytes));
  mallopt(M_TOP_PAD, static_cast<int>(kOwnMappingBytes));
#endif
}

void return_unused_memory() {
  kept_blocks().free_all();
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace dubsar
