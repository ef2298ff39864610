// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "core/heap.h"

namespace dubsar {

/// Blocks of memory that lie in files. They are read and written as any other, but the system may write them
/// out and give their pages to something else: what is too large for memory goes on, slower, where it would
/// have been killed. The files have no name and are gone with the block, or with the program however it ends.
/// They lie in $TMPDIR, else in /var/tmp; never on a disk that is memory itself (tmpfs).

/// From this size on a block is worth a file of its own, bytes.
inline constexpr std::size_t kLeastFileBlock = kOwnMappingBytes;

/// True when a block of this size had better lie in a file: less than a quarter of the machine's memory (or
/// of what its control group grants the program) would be left. Always with DUBSAR_ARRAYS=files in the
/// environment, never with DUBSAR_ARRAYS=memory.
[[nodiscard]] bool belongs_in_file(std::size_t bytes) noexcept;

/// Null when there is no disk to take it, or no room on it.
[[nodiscard]] void* allocate_file_block(std::size_t bytes, std::size_t alignment) noexcept;
/// False when it is no file block: then nothing was done. Null is none.
bool free_file_block(void* block) noexcept;

/// The most that ever lay in files at once, bytes.
[[nodiscard]] std::size_t most_file_block_bytes() noexcept;

}  // namespace dubsar
