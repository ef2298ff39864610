// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning/clearing.h"
#include "planning/surface_cover.h"

namespace dubsar {

namespace {

/// Flatter surface is sampled every two cells at least by one sample a block.
constexpr float kSteepCosine = 0.5F;

/// Across two steps of `step` samples each way, as far as they lie on one surface.
Eigen::Vector3f normal_at(const RangeGrid& grid, int row, int col, int step, float longest2) {
  const Eigen::Vector3f here = grid.point(grid.index(row, col));
  const auto there = [&](int r, int c) {
    if (!grid.inside(r, c) || !grid.is_valid(r, c)) {
      return here;
    }
    const Eigen::Vector3f p = grid.point(grid.index(r, c));
    return (p - here).squaredNorm() <= longest2 ? p : here;
  };
  const Eigen::Vector3f along = there(row, col + step) - there(row, col - step);
  const Eigen::Vector3f across = there(row + step, col) - there(row - step, col);
  // Not to the camera: where it stands may be told wrongly, and then steep surface would look inwards.
  const Eigen::Vector3f towards = -grid.view.direction.cast<float>();
  const Eigen::Vector3f n = along.cross(across);
  const float length = n.norm();
  return length > 1e-12F ? Eigen::Vector3f(n * ((n.dot(towards) < 0 ? -1.0F : 1.0F) / length)) : towards;
}

}  // namespace

std::vector<SurfaceCover::Element> SurfaceCover::elements_of(const PlacedScan& scan, double cell_mm) {
  const RangeGrid& grid = *scan.grid;
  const double spacing_mm = std::max(spacing_of(grid), 1e-6);
  const int stride = std::max(1, static_cast<int>(std::lround(cell_mm / spacing_mm)));
  const auto longest2 = static_cast<float>(std::pow(4.0 * stride * spacing_mm, 2.0));
  const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
  const Eigen::Vector3f translation = scan.model_from_scanner.translation_mm.cast<float>();
  const auto good = [&](int r, int c) {
    const std::size_t i = grid.index(r, c);
    return grid.valid[i] != 0 && is_unflagged((*scan.flags)[i]) && grid.point(i).allFinite();
  };
  std::vector<Element> out;
  for (int row = 0; row < grid.rows; row += stride) {
    for (int col = 0; col < grid.cols; col += stride) {
      // Of a block, the first good sample; where the surface is steep all of them, lest it fall apart.
      for (int k = 0; k < stride * stride; ++k) {
        const int r = row + k / stride;
        const int c = col + k % stride;
        if (!grid.inside(r, c) || !good(r, c)) {
          continue;
        }
        const Eigen::Vector3f p = grid.point(grid.index(r, c));
        const Eigen::Vector3f n = normal_at(grid, r, c, stride, longest2);
        out.push_back({rotation * p + translation, rotation * n});
        if (-n.dot(grid.view.direction.cast<float>()) > kSteepCosine) {
          break;
        }
      }
    }
  }
  return out;
}

}  // namespace dubsar
