// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/sample_normals.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kRowsPerTask = 32;

/// One float per column and axis, with a column of zeros on either side.
struct Lines {
  explicit Lines(std::size_t cols) {
    for (std::vector<float>& axis : of) {
      axis.assign(cols + 2, 0.0F);
    }
  }
  [[nodiscard]] float* axis(std::size_t k) { return of[k].data() + 1; }
  std::array<std::vector<float>, 3> of;
};

/// From each of the cells `from`… to the one beside it, where both hold a sample and no step lies between.
void link(const RangeGrid& grid, std::size_t from, std::size_t beside, std::size_t count, float step2_mm2,
          Lines& lines) {
  const std::uint8_t* const valid_a = grid.valid.data() + from;
  const std::uint8_t* const valid_b = grid.valid.data() + beside;
  const std::array<const float*, 3> a{grid.x.data() + from, grid.y.data() + from, grid.z.data() + from};
  const std::array<const float*, 3> b{grid.x.data() + beside, grid.y.data() + beside, grid.z.data() + beside};
  float* const lx = lines.axis(0);
  float* const ly = lines.axis(1);
  float* const lz = lines.axis(2);
  for (std::size_t c = 0; c < count; ++c) {
    const float dx = b[0][c] - a[0][c];
    const float dy = b[1][c] - a[1][c];
    const float dz = b[2][c] - a[2][c];
    const bool linked = valid_a[c] != 0 && valid_b[c] != 0 && dx * dx + dy * dy + dz * dz <= step2_mm2;
    lx[c] = linked ? dx : 0.0F;
    ly[c] = linked ? dy : 0.0F;
    lz[c] = linked ? dz : 0.0F;
  }
}

}  // namespace

SampleNormals::SampleNormals(const RangeGrid& grid, float step_mm) : packed_(grid.size()) {
  const auto cols = static_cast<std::size_t>(grid.cols);
  const auto rows = static_cast<std::size_t>(grid.rows);
  const float step2_mm2 = step_mm * step_mm;
  const bool has_camera = grid.view.camera_mm.has_value();
  const Eigen::Vector3d at = has_camera ? *grid.view.camera_mm : -grid.view.direction;
  parallel_chunks(cols > 0 ? rows : 0, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    Lines right(cols);
    Lines above(cols);
    Lines below(cols);
    if (begin > 0) {
      link(grid, (begin - 1) * cols, begin * cols, cols, step2_mm2, below);
    }
    for (std::size_t row = begin; row < end; ++row) {
      std::swap(above, below);
      const std::size_t first = row * cols;
      link(grid, first, first + 1, cols - 1, step2_mm2, right);
      if (row + 1 < rows) {
        link(grid, first, first + cols, cols, step2_mm2, below);
      } else {
        below = Lines(cols);
      }
      const Eigen::Vector3f camera =
          (has_camera ? Eigen::Vector3d(at + static_cast<double>(row) * grid.view.motion_per_row_mm) : at)
              .cast<float>();
      const float follows = has_camera ? 1.0F : 0.0F;
      const float* const rx = right.axis(0);
      const float* const ry = right.axis(1);
      const float* const rz = right.axis(2);
      const float* const ax = above.axis(0);
      const float* const ay = above.axis(1);
      const float* const az = above.axis(2);
      const float* const bx = below.axis(0);
      const float* const by = below.axis(1);
      const float* const bz = below.axis(2);
      for (std::size_t c = 0; c < cols; ++c) {
        const std::size_t i = first + c;
        // Over both neighbours; the sample itself stands in for one that is missing or across a step.
        const float ux = rx[c] + rx[static_cast<std::ptrdiff_t>(c) - 1];
        const float uy = ry[c] + ry[static_cast<std::ptrdiff_t>(c) - 1];
        const float uz = rz[c] + rz[static_cast<std::ptrdiff_t>(c) - 1];
        const float vx = ax[c] + bx[c];
        const float vy = ay[c] + by[c];
        const float vz = az[c] + bz[c];
        const float nx = uy * vz - uz * vy;
        const float ny = uz * vx - ux * vz;
        const float nz = ux * vy - uy * vx;
        const float toward = nx * (camera.x() - follows * grid.x[i]) +
                             ny * (camera.y() - follows * grid.y[i]) +
                             nz * (camera.z() - follows * grid.z[i]);
        const float length = std::sqrt(nx * nx + ny * ny + nz * nz);
        const float scale = length > 1e-12F ? (toward < 0 ? -kOne : kOne) / length : 0.0F;
        const auto part = [&](float n) {
          const float scaled = scale * n + (static_cast<float>(kZero) + 0.5F);
          return static_cast<std::uint32_t>(static_cast<std::int32_t>(scaled));
        };
        packed_[i] = part(nx) | part(ny) << 10 | part(nz) << 20;
      }
    }
  });
}

}  // namespace dubsar
