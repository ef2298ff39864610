// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/placed_scan.h"
#include "core/range_grid.h"
#include "formats/grid_reader.h"
#include "formats/mesh_io.h"
#include "formats/poses_conf.h"
#include "tests/support/real_data.h"

namespace dubsar::test {

/// Flags by the rule of seed 001, 3.3, in plain words: slow, and enough for a test.
inline SampleFlags sparse_flags(const RangeGrid& grid) {
  SampleFlags flags(grid.size(), 0);
  const double most_mm = 3.0 * grid.spacing_mm;
  const auto apart = [&](int row, int col, int other_row, int other_col) {
    return !grid.is_valid(other_row, other_col) ||
           (grid.point(grid.index(row, col)) - grid.point(grid.index(other_row, other_col))).norm() > most_mm;
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      if (grid.is_valid(row, col) && (apart(row, col, row, col - 1) || apart(row, col, row, col + 1) ||
                                      apart(row, col, row - 1, col) || apart(row, col, row + 1, col))) {
        flags[grid.index(row, col)] = kPotentiallySparse;
      }
    }
  }
  SampleFlags out = flags;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      int around = 0;
      for (int r = row - 1; r <= row + 1; ++r) {
        for (int c = col - 1; c <= col + 1; ++c) {
          const bool self = r == row && c == col;
          around +=
              !self && (!grid.is_valid(r, c) || (flags[grid.index(r, c)] & kPotentiallySparse) != 0) ? 1 : 0;
        }
      }
      if (grid.is_valid(row, col) && around > 4) {
        out[grid.index(row, col)] |= kSparse;
      }
    }
  }
  return out;
}

/// Grids with flags at addresses that stay, and the placed scans that refer to them.
struct ScanSet {
  std::deque<RangeGrid> grids;
  std::deque<SampleFlags> flags;
  std::vector<PlacedScan> placed;

  void add(RangeGrid grid, const RigidTransform& model_from_scanner, double sigma_mm = 0) {
    if (!(grid.spacing_mm > 0)) {
      grid.spacing_mm = estimate_spacing_mm(grid);
    }
    flags.push_back(sparse_flags(grid));
    grids.push_back(std::move(grid));
    placed.push_back(
        {static_cast<int>(placed.size()), &grids.back(), &flags.back(), model_from_scanner, sigma_mm});
  }
  [[nodiscard]] std::size_t samples() const {
    std::size_t n = 0;
    for (const RangeGrid& g : grids) {
      n += g.valid_count();
    }
    return n;
  }
};

/// A grid of rows × cols over the analytic height z(x, y) in the scanner frame, seen along -z; NaN heights
/// are missing samples. Mirrored grids run their columns against x.
inline RangeGrid height_grid(int rows, int cols, double spacing_mm,
                             const std::function<double(double, double)>& z, bool mirrored = false) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  grid.spacing_mm = spacing_mm;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = grid.index(row, col);
      const double x = (mirrored ? -1 : 1) * (col - 0.5 * (cols - 1)) * spacing_mm;
      const double y = (row - 0.5 * (rows - 1)) * spacing_mm;
      const double height = z(x, y);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(height);
      grid.valid[i] = std::isfinite(height) ? 1 : 0;
    }
  }
  return grid;
}

/// The Stanford bunny's scans in the model frame of bun.conf, millimetres; empty when it is not there.
inline ScanSet bunny(int stride = 1) {
  ScanSet set;
  const std::filesystem::path folder = real_data() / "stanford_bunny";
  const auto poses = read_conf_poses(folder / "bun.conf", 1000.0);
  if (!poses) {
    return set;
  }
  for (const ScanPose& pose : *poses) {
    auto scans = read_scan_file(folder / pose.file, {1000.0});
    if (!scans || scans->empty() || !std::holds_alternative<RangeGrid>(scans->front())) {
      return {};
    }
    RangeGrid grid = std::get<RangeGrid>(std::move(scans->front()));
    if (!(grid.spacing_mm > 0)) {
      grid.spacing_mm = estimate_spacing_mm(grid);
    }
    set.add(decimated(grid, stride), pose.model_from_scanner, 0.1);
  }
  return set;
}

/// Vertices of the published zippered bunny, millimetres; empty when it is not there.
inline std::vector<Eigen::Vector3f> bunny_zipper() {
  const auto mesh = read_mesh(real_data() / "stanford_bunny" / "reconstruction" / "bun_zipper.ply",
                              {.mm_per_unit = 1000.0});
  return mesh ? mesh->positions : std::vector<Eigen::Vector3f>();
}

}  // namespace dubsar::test
