// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <mutex>

#include "core/heap.h"

namespace dubsar {

/// Large blocks of malloc's that were let go of, kept for whoever next asks for about as much: what comes
/// from the system is cleared page by page, and a stitch takes and lets go of much the same arrays again and
/// again.
///
/// What is kept and what is in use never exceed the most that was in use at once, so that no program needs
/// more memory for it; nor is more than kMostKept kept, which a program has that has gone on to other work.
///
/// For an operator new: nothing here throws or takes memory.
class KeptBlocks {
 public:
  /// From this size on a block is kept, bytes: smaller ones do not go back to the system anyway.
  static constexpr std::size_t kLeastBlock = kOwnMappingBytes;
  static constexpr std::size_t kMostKept = std::size_t{256} << 20U;  ///< bytes

  /// A kept block of that size or up to a quarter more, its contents whatever they were; null when there is
  /// none: then malloc is to be asked.
  [[nodiscard]] void* take(std::size_t bytes) noexcept;
  /// To be told of each block of at least kLeastBlock that malloc was asked for.
  void count(void* block) noexcept;
  /// What is let go of. False when it is not large or not to be kept: then it is to be freed.
  [[nodiscard]] bool keep(void* block) noexcept;
  /// Frees all that is kept.
  void free_all() noexcept;

  [[nodiscard]] std::size_t kept_bytes() noexcept;

 private:
  struct Kept {
    void* block = nullptr;
    std::size_t bytes = 0;
  };
  void take_out(std::size_t k);
  void free_until(std::size_t most_bytes);

  std::mutex mutex_;
  std::array<Kept, 64> kept_{};  ///< the oldest first
  std::size_t size_ = 0;
  std::size_t kept_bytes_ = 0;
  std::size_t used_bytes_ = 0;
  std::size_t most_used_bytes_ = 0;
};

/// Those of the program's operator new.
KeptBlocks& kept_blocks() noexcept;

}  // namespace dubsar
