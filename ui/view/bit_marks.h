// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace dubsar::ui {

/// Which of so many are marked, a bit each. Words go together by 32: of the 1024 elements that they hold,
/// each has every 32nd, so that neighbours on a graphics card, which work on a word each, look at elements
/// that lie side by side.
class BitMarks {
 public:
  [[nodiscard]] static constexpr std::size_t words_for(std::size_t count) {
    return 32 * ((count + kTogether - 1) / kTogether);
  }

  explicit BitMarks(std::size_t count) : count_(count), words_(words_for(count), 0) {}
  /// `words` are words_for(count); no bit of theirs is set beyond the last element.
  BitMarks(std::size_t count, std::vector<std::uint32_t> words) : count_(count), words_(std::move(words)) {}
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool operator[](std::size_t k) const { return (words_[word_of(k)] & bit_of(k)) != 0; }
  void mark(std::size_t k) { words_[word_of(k)] |= bit_of(k); }
  [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }
  [[nodiscard]] std::size_t marked() const {
    std::size_t sum = 0;
    for (const std::uint32_t word : words_) {
      sum += static_cast<std::size_t>(std::popcount(word));
    }
    return sum;
  }
  bool operator==(const BitMarks&) const = default;

 private:
  // kIsMarked (shaders.h) and what MeshSelecting draws look for them there.
  static constexpr std::size_t kTogether = 1024;
  [[nodiscard]] static constexpr std::size_t word_of(std::size_t k) { return k / kTogether * 32 + k % 32; }
  [[nodiscard]] static constexpr std::uint32_t bit_of(std::size_t k) { return 1U << (k / 32 % 32); }

  std::size_t count_;
  std::vector<std::uint32_t> words_;
};

/// Of the faces in the order of ShownMesh::faces, or of the vertices: the selected.
using SelectionMarks = std::shared_ptr<const BitMarks>;

}  // namespace dubsar::ui
