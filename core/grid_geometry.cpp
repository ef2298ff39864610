// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/huge_pages.h"
#include "core/parallel.h"
#include "core/row_camera.h"
#include "core/wide_clones.h"

namespace dubsar {

namespace {

/// Samples that are worked on at a time: what they need lies in the first cache.
constexpr int kBlock = 64;

/// Part of a row with one sample more at either end, each quantity by itself, so that the compiler can work
/// on several at once.
struct Samples {
  float x[kBlock + 2] = {}, y[kBlock + 2] = {}, z[kBlock + 2] = {};
  std::int32_t valid[kBlock + 2] = {};

  /// From column `col` on; those outside of the grid are not valid.
  [[gnu::always_inline]] void fill(const RangeGrid& grid, int row, int col, int count) {
    if (row < 0 || row >= grid.rows) {
      std::fill_n(valid, count, 0);
    } else if (col >= 0 && count == kBlock + 2 && col + count <= grid.cols) {
      take(grid, grid.index(row, col), 0, kBlock + 2);
    } else {
      std::fill_n(valid, count, 0);
      const int begin = std::max(col, 0);
      take(grid, grid.index(row, begin), begin - col, std::min(col + count, grid.cols) - col);
    }
  }

 private:
  /// [begin, end) of this part, from the grid's sample `first` on. Inlined with constants it is a few moves.
  [[gnu::always_inline]] void take(const RangeGrid& grid, std::size_t first, int begin, int end) {
    for (int c = begin; c < end; ++c) {
      const std::size_t i = first + static_cast<std::size_t>(c - begin);
      x[c] = grid.x[i];
      y[c] = grid.y[i];
      z[c] = grid.z[i];
      valid[c] = grid.valid[i] != 0 ? 1 : 0;
    }
  }
};

struct Step {
  float x, y, z;
  std::int32_t holds;
};

/// Zero to where the sample is not valid, or across a step.
[[gnu::always_inline]] inline Step step(const Samples& from, int i, const Samples& to, int k,
                                        float most2_mm2) {
  const float x = to.x[k] - from.x[i];
  const float y = to.y[k] - from.y[i];
  const float z = to.z[k] - from.z[i];
  const std::int32_t holds = to.valid[k] & static_cast<std::int32_t>(x * x + y * y + z * z <= most2_mm2);
  return {holds != 0 ? x : 0.0F, holds != 0 ? y : 0.0F, holds != 0 ? z : 0.0F, holds};
}

DUBSAR_WIDE_CLONES void row_geometry(const RangeGrid& grid, int row, float step2_mm2, GridGeometry& out) {
  const RowCamera camera(grid.view, row);
  const float at_x = camera.at().x(), at_y = camera.at().y(), at_z = camera.at().z();
  const float known = camera.is_known() ? 1.0F : 0.0F;
  Samples above, here, below;
  float nx[kBlock], ny[kBlock], nz[kBlock];
  std::int32_t boundary[kBlock];
  for (int begin = 0; begin < grid.cols; begin += kBlock) {
    const int count = std::min(grid.cols - begin, kBlock);
    above.fill(grid, row - 1, begin - 1, count + 2);
    here.fill(grid, row, begin - 1, count + 2);
    below.fill(grid, row + 1, begin - 1, count + 2);
    for (int c = 0; c < count; ++c) {
      const int i = c + 1;
      const Step after = step(here, i, here, i + 1, step2_mm2),
                 before = step(here, i, here, i - 1, step2_mm2);
      const Step down = step(here, i, below, i, step2_mm2), up = step(here, i, above, i, step2_mm2);
      boundary[c] = here.valid[i] & (1 - (after.holds & before.holds & down.holds & up.holds));
      const float ax = after.x - before.x, ay = after.y - before.y, az = after.z - before.z;
      const float dx = down.x - up.x, dy = down.y - up.y, dz = down.z - up.z;
      const float x = ay * dz - az * dy, y = az * dx - ax * dz, z = ax * dy - ay * dx;
      const float length = std::sqrt(x * x + (y * y + z * z));
      const float towards =
          x * (at_x - known * here.x[i]) + (y * (at_y - known * here.y[i]) + z * (at_z - known * here.z[i]));
      const std::int32_t has = here.valid[i] & static_cast<std::int32_t>(length > 1e-12F);
      const float scale = (towards < 0 ? -1.0F : 1.0F) / length;
      nx[c] = has != 0 ? x * scale : 0.0F;
      ny[c] = has != 0 ? y * scale : 0.0F;
      nz[c] = has != 0 ? z * scale : 0.0F;
    }
    const std::size_t first = grid.index(row, begin);
    for (int c = 0; c < count; ++c) {
      out.normals[first + static_cast<std::size_t>(c)] = {nx[c], ny[c], nz[c]};
      out.boundary[first + static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(boundary[c]);
    }
  }
}

}  // namespace

GridGeometry grid_geometry(const RangeGrid& grid, double step_factor) {
  return grid_geometry_within(grid, step_factor * grid.spacing_mm);
}

GridGeometry grid_geometry_within(const RangeGrid& grid, double step_mm) {
  GridGeometry out;
  resize_in_huge_pages(out.normals, grid.size());
  out.boundary.resize(grid.size());
  const auto step = static_cast<float>(step_mm);
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t row) { row_geometry(grid, static_cast<int>(row), step * step, out); }, 8);
  return out;
}

}  // namespace dubsar
