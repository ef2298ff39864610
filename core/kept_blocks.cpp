// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/kept_blocks.h"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>

namespace dubsar {

void* KeptBlocks::take(std::size_t bytes) noexcept {
  const std::scoped_lock lock(mutex_);
  std::size_t best = size_;
  for (std::size_t k = 0; k < size_; ++k) {
    const std::size_t has = kept_[k].bytes;
    if (has >= bytes && has - bytes <= bytes / 4 && (best == size_ || has < kept_[best].bytes)) {
      best = k;
    }
  }
  if (best == size_) {
    const std::size_t will_use = used_bytes_ + bytes;
    free_until(most_used_bytes_ - std::min(will_use, most_used_bytes_));
    return nullptr;
  }
  void* const block = kept_[best].block;
  used_bytes_ += kept_[best].bytes;
  take_out(best);
  return block;
}

void KeptBlocks::count(void* block) noexcept {
  const std::scoped_lock lock(mutex_);
  used_bytes_ += malloc_usable_size(block);
  most_used_bytes_ = std::max(most_used_bytes_, used_bytes_);
}

bool KeptBlocks::keep(void* block) noexcept {
  const std::size_t bytes = block == nullptr ? 0 : malloc_usable_size(block);
  if (bytes < kLeastBlock) {
    return false;
  }
  const std::scoped_lock lock(mutex_);
  // What malloc rounded up to a large block was not counted.
  used_bytes_ -= std::min(bytes, used_bytes_);
  if (bytes > kMostKept) {
    return false;
  }
  free_until(kMostKept - bytes);
  if (size_ == kept_.size()) {
    free_until(kept_bytes_ - 1);
  }
  kept_[size_++] = {block, bytes};
  kept_bytes_ += bytes;
  return true;
}

void KeptBlocks::free_all() noexcept {
  const std::scoped_lock lock(mutex_);
  free_until(0);
}

std::size_t KeptBlocks::kept_bytes() noexcept {
  const std::scoped_lock lock(mutex_);
  return kept_bytes_;
}

void KeptBlocks::take_out(std::size_t k) {
  kept_bytes_ -= kept_[k].bytes;
  std::copy(kept_.begin() + static_cast<std::ptrdiff_t>(k) + 1,
            kept_.begin() + static_cast<std::ptrdiff_t>(size_),
            kept_.begin() + static_cast<std::ptrdiff_t>(k));
  --size_;
}

void KeptBlocks::free_until(std::size_t most_bytes) {
  while (kept_bytes_ > most_bytes) {
    std::free(kept_[0].block);
    take_out(0);
  }
}

KeptBlocks& kept_blocks() noexcept {
  static constinit KeptBlocks blocks;  // never destroyed: blocks are let go of to the very end
  return blocks;
}

}  // namespace dubsar
