// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The program's own operator new: arrays of megabytes go into files when memory is short
// (core/file_blocks.h), whatever container holds them and whichever stage asks. Everything else is malloc's,
// what is large on huge pages where the system has them, and kept for the next who asks for as much
// (core/kept_blocks.h): much of the time of a large stitch went to taking page after page.
//
// Only of the program `dubsar`: a library leaves the operators to whoever links it, and the sanitizers bring
// their own.

#include <cstdlib>
#include <new>

#include "core/file_blocks.h"
#include "core/huge_pages.h"
#include "core/kept_blocks.h"

namespace {

/// From here on a block may lie in a file, or be kept.
constexpr std::size_t kLarge = dubsar::KeptBlocks::kLeastBlock;
static_assert(kLarge == dubsar::kLeastFileBlock);

void* take(std::size_t size, std::size_t alignment) noexcept {
  const bool is_plain = alignment <= alignof(std::max_align_t);
  const bool is_large = size >= kLarge;
  if (is_large && is_plain) {
    if (void* const block = dubsar::kept_blocks().take(size)) {
      return block;
    }
  }
  if (is_large && dubsar::belongs_in_file(size)) {
    dubsar::kept_blocks().free_all();
    if (void* const block = dubsar::allocate_file_block(size, alignment)) {
      return block;
    }
  }
  const std::size_t least = size == 0 ? 1 : size;
  void* const block = is_plain
                          ? std::malloc(least)
                          : std::aligned_alloc(alignment, (least + alignment - 1) / alignment * alignment);
  if (is_large && block != nullptr) {
    dubsar::wish_for_huge_pages(block, size);
    dubsar::kept_blocks().count(block);
  }
  return block;
}

void* take_or_throw(std::size_t size, std::size_t alignment) {
  for (;;) {
    if (void* const memory = take(size, alignment)) {
      return memory;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) {
      throw std::bad_alloc();
    }
    handler();
  }
}

void give_back(void* memory) noexcept {
  if (!dubsar::free_file_block(memory) && !dubsar::kept_blocks().keep(memory)) {
    std::free(memory);
  }
}

/// Most are small, and who says so spares the look at what malloc knows of the block.
void give_back(void* memory, std::size_t size) noexcept {
  if (size < kLarge) {
    std::free(memory);
  } else {
    give_back(memory);
  }
}

constexpr std::size_t kPlain = alignof(std::max_align_t);

}  // namespace

// The array and nothrow forms of the standard library call these.
void* operator new(std::size_t size) {
  return take_or_throw(size, kPlain);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take_or_throw(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  give_back(memory);
}
void operator delete(void* memory, std::size_t size) noexcept {
  give_back(memory, size);
}
void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  give_back(memory);
}
void operator delete(void* memory, std::size_t size, std::align_val_t /*alignment*/) noexcept {
  give_back(memory, size);
}
