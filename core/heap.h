// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

namespace dubsar {

/// Blocks of this size and above are taken from the system one by one, and go back to it when let go of.
inline constexpr std::size_t kOwnMappingBytes = std::size_t{1} << 20U;

/// Large arrays go back to the system when they are let go of, instead of lying about in the heap between
/// smaller ones: it halves the memory of a large stitch. What is smaller is kept at the end of the heap, up
/// to 4 MiB for each thread. For the whole process, so a program says it first thing in main() and no
/// library does. (glibc; with another allocator nothing happens.)
void map_large_blocks();

/// What the program has let go of goes back to the system, from the heaps of threads that have ended, too.
void return_unused_memory();

}  // namespace dubsar
