// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/heap.h"

#include <cstdlib>  // defines __GLIBC__ where it is

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "core/kept_blocks.h"

namespace dubsar {

void map_large_blocks() {
#if defined(__GLIBC__)
  // Said outright, it also stays: left alone, glibc raises the threshold to the largest block that was let go
  // of.
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(kOwnMappingBytes));
#endif
}

void return_unused_memory() {
  kept_blocks().free_all();
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace dubsar
