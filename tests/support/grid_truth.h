// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/grid_builder.h"
#include "core/mesh_query.h"
#include "core/order_statistics.h"
#include "drivers/device.h"

namespace dubsar::test {

/// Puts a scan together and keeps its end.
struct CollectGrid : ProfileSink {
  bool begin(const ScanInfo& info) override {
    builder.emplace(info);
    return true;
  }
  bool profile(const Profile& profile) override {
    builder->append(profile);
    return !stop_after || builder->grid().rows < *stop_after;
  }
  void end(const ScanTally& ended) override { tally = ended; }
  [[nodiscard]] RangeGrid grid() {
    if (!builder) {
      return {};
    }
    builder->estimate_spacing();
    return builder->take();
  }
  std::optional<GridBuilder> builder;
  std::optional<int> stop_after;
  ScanTally tally;
};

[[nodiscard]] inline double top_mm(const Mesh& mesh) {
  double out = -1e9;
  for (const Eigen::Vector3f& p : mesh.positions) {
    out = std::max(out, static_cast<double>(p.z()));
  }
  return out;
}

/// How far the rows lie from the nearest of the positions that there are frames of, RMS: the middle one of
/// each row's samples, for those at edges are moved to where the sheet's middle passed them. `per_mm` is
/// where a millimetre of the stage leads, scanner frame.
[[nodiscard]] inline double row_rms_um(const RangeGrid& grid, const std::vector<double>& positions,
                                       const Eigen::Vector3d& per_mm) {
  double squares = 0;
  int rows = 0;
  std::vector<double> along;
  for (int row = 0; row < grid.rows; ++row) {
    along.clear();
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t i = grid.index(row, col);
      if (grid.valid[i] != 0) {
        // The profile's plane stands across the motion: x and z of a sample do not matter.
        along.push_back(static_cast<double>(grid.y[i]) / per_mm.y());
      }
    }
    if (along.empty()) {
      continue;
    }
    double nearest = 1e9;
    for (const double position : positions) {
      nearest = std::min(nearest, std::abs(position - median_of(along)));
    }
    squares += 1e6 * nearest * nearest;
    ++rows;
  }
  return std::sqrt(squares / std::max(rows, 1));
}

struct DepthErrors {
  double rms_um = 0;
  double bias_um = 0;
  double missed = 0;    ///< share of the samples with no surface within 0.2 mm above or below
  double clean_um = 0;  ///< RMS without the samples that are off by more than the limit
  double off = 0;       ///< share of those
};

/// How far the samples lie above the true surface, along z of its frame.
[[nodiscard]] inline DepthErrors depth_errors(const RangeGrid& grid, const RigidTransform& tablet_from_grid,
                                              const MeshQuery& truth, double limit_um = 200) {
  DepthErrors out;
  double sum = 0;
  double squares = 0;
  double clean = 0;
  std::size_t off = 0;
  std::size_t clean_count = 0;
  std::size_t count = 0;
  std::size_t missed = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3d p =
        tablet_from_grid * Eigen::Vector3d(static_cast<double>(grid.x[i]), static_cast<double>(grid.y[i]),
                                           static_cast<double>(grid.z[i]));
    const auto hit =
        truth.first_hit((p + Eigen::Vector3d(0, 0, 1)).cast<float>(), -Eigen::Vector3f::UnitZ(), 0, 3);
    const double error = hit ? 1e3 * (static_cast<double>(hit->distance_mm) - 1.0) : 1e9;
    if (!(std::abs(error) < 200)) {
      ++missed;
      continue;
    }
    ++count;
    sum += error;
    squares += error * error;
    (std::abs(error) > limit_um ? off : clean_count) += 1;
    clean += std::abs(error) > limit_um ? 0 : error * error;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
  out.bias_um = sum / n;
  out.rms_um = std::sqrt(squares / n);
  out.clean_um = std::sqrt(clean / static_cast<double>(std::max<std::size_t>(clean_count, 1)));
  out.off = static_cast<double>(off) / n;
  out.missed = static_cast<double>(missed) / static_cast<double>(std::max<std::size_t>(count + missed, 1));
  return out;
}

}  // namespace dubsar::test
