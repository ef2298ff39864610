// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dubsar {

/// The curve that a tablet is rolled along: the outline of its side, seen along the lines of writing, closed,
/// convex and without corners. Coordinates are (y, z) of the tablet frame, mm. It begins between top edge and
/// obverse and runs down the obverse, round the bottom edge, up the reverse and over the top edge. Lengths
/// along it are those of the convex outline, from which the rounding took it inwards where that bends.
class SideCurve {
 public:
  /// Round these points. Fewer than three, or all on a line: empty().
  explicit SideCurve(const std::vector<Eigen::Vector2f>& yz_mm);

  [[nodiscard]] bool empty() const { return points_.empty(); }
  [[nodiscard]] double length_mm() const { return step_mm_ * static_cast<double>(points_.size()); }

  /// Where a point lies with respect to the curve.
  struct Place {
    double along_mm = 0;            ///< from the beginning to the nearest point of the curve, [0, length)
    double off_mm = 0;              ///< how far outside of it; negative inside
    Eigen::Vector2d outward{0, 1};  ///< unit normal of the curve there, (y, z)
  };
  [[nodiscard]] Place place(const Eigen::Vector2d& yz_mm) const;
  /// Where the curve looks most in a direction, (y, z), from the beginning.
  [[nodiscard]] double along_facing_mm(const Eigen::Vector2d& direction) const;

 private:
  void make_lookup();
  [[nodiscard]] std::size_t next(std::size_t i) const { return i + 1 == points_.size() ? 0 : i + 1; }
  [[nodiscard]] std::size_t before(std::size_t i) const { return i == 0 ? points_.size() - 1 : i - 1; }

  std::vector<Eigen::Vector2d> points_;  ///< one for each step along the outline
  std::vector<Eigen::Vector2d> outward_;
  double step_mm_ = 0;  ///< of the outline
  /// The nearest point of the curve by cell of a coarse grid: where place() begins to look.
  std::vector<std::uint32_t> lookup_;
  Eigen::Vector2d low_mm_{0, 0};
  int cells_y_ = 0, cells_z_ = 0;
};

}  // namespace dubsar
