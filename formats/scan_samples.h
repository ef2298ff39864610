// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// Samples as a file lists them, in millimetres, before they take their cells. Optional arrays are empty or
/// as long as x.
struct ScanSamples {
  std::vector<float> x, y, z;
  std::vector<std::uint8_t> usable;  ///< 0: no return, NaN, infinite or out of all bounds
  std::vector<float> intensity;
  std::vector<float> confidence;
  std::vector<std::uint8_t> rgb;  ///< [3N]
  std::vector<float> normals;     ///< [3N]

  std::size_t too_far = 0;  ///< unusable for being beyond kMaxCoordinateMm alone

  [[nodiscard]] std::size_t size() const { return x.size(); }
  /// Appends a position; unusable when it is not finite or beyond kMaxCoordinateMm.
  void add(double x_mm, double y_mm, double z_mm, bool usable_sample = true);
  /// kBadInput when most of what was returned lies too far away: an object is there, not a stray.
  [[nodiscard]] Status check_place(const std::string& name) const;
};

inline constexpr std::uint32_t kNoSample = 0xffffffffU;

/// The grid whose cell i holds sample samples_of_cells[i]; an empty list takes the samples in their order.
/// Each sample stands in at most one cell.
[[nodiscard]] RangeGrid grid_from_samples(const ScanSamples& samples, int rows, int cols,
                                          const std::vector<std::uint32_t>& sample_of_cell);

/// The usable samples, in order.
[[nodiscard]] PointCloud cloud_from_samples(const ScanSamples& samples);

/// A normal as a file has it, of any length, as unit vector; zero where it has no direction.
[[nodiscard]] Eigen::Vector3f unit_or_zero(const Eigen::Vector3f& normal);

/// The last part of a path: what a scan is known by.
[[nodiscard]] std::string file_name_of(const std::string& path);

/// Brings intensities to [0, 1]: values up to 1 stay, bytes are divided by 255, anything larger by the
/// largest. NaN and negative values become 0.
void normalise_intensity(std::vector<float>& intensity);

}  // namespace dubsar
