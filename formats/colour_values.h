// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/ply_header.h"

namespace dubsar {

/// The byte of a colour from 0 to 1; what lies outside becomes the nearest one, NaN 0.
[[nodiscard]] std::uint8_t colour_byte(double share);

/// Whether a number without a largest value of its own (a float, text) is one of a file whose colours run to
/// 255 and not to 1: rounding, or light brighter than white, takes those to 1 a little beyond.
[[nodiscard]] bool runs_to_255(double value);

/// Red, green and blue of the vertices of a PLY file, as bytes: those of a type of whole numbers run to its
/// largest value (of four bytes: to 255), those of floats to 1, or to 255 where any says so
/// (runs_to_255()). Which of the two is known only behind the last vertex; until then both are kept.
class PlyColours {
 public:
  /// As many as the element has vertices; none where it lacks one of the three.
  explicit PlyColours(const PlyElement& vertex);

  /// Those of red, green and blue, or of diffuse_red and so on, as some programs write them; -1 where there
  /// are none.
  [[nodiscard]] static std::array<int, 3> properties_of(const PlyElement& vertex);

  [[nodiscard]] bool any() const { return property_[0] >= 0; }
  /// value(property) -> double, of one vertex. Several threads may put different vertices.
  template <class Value>
  void put(std::size_t vertex, const Value& value) {
    for (std::size_t k = 0; k < 3 && any(); ++k) {
      put(vertex, k, value(property_[k]));
    }
  }
  /// What was put; black where nothing was.
  [[nodiscard]] std::vector<std::array<std::uint8_t, 3>> take();

 private:
  using Bytes = std::vector<std::array<std::uint8_t, 3>>;
  void put(std::size_t vertex, std::size_t k, double value);

  std::array<int, 3> property_{-1, -1, -1};
  double largest_ = 1;  ///< of the type; 1 for floats
  bool floats_ = false;
  Bytes to_largest_;
  Bytes to_255_;  ///< of floats
  std::atomic<bool> any_runs_to_255_ = false;
};

}  // namespace dubsar
