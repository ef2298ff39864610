// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace dubsar::ui {

/// How many faces, or vertices, are worked through between two looks at what the user does: learned from how
/// long the pieces before took this machine.
class PieceSize {
 public:
  explicit PieceSize(std::size_t first) : count_(first) {}
  [[nodiscard]] std::size_t count() const { return count_; }
  /// A piece of so many is done. One that was smaller than asked for, as the last of all is, says nothing of
  /// larger ones.
  void took(std::size_t done, std::chrono::duration<double> spent) {
    if (spent.count() < 0.4 * kSoonS && done >= count_) {
      count_ = std::min(2 * count_, kMost);
    } else if (spent.count() > kSoonS) {
      count_ = std::max(count_ / 2, kFewest);
    }
  }

 private:
  static constexpr double kSoonS = 0.04;
  static constexpr std::size_t kFewest = 20000;  ///< however slow the machine is
  static constexpr std::size_t kMost = std::size_t{1} << 30U;
  std::size_t count_;
};

}  // namespace dubsar::ui
