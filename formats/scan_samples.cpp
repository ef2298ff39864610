// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/scan_samples.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "formats/grid_reader.h"
#include "formats/place_precision.h"

namespace dubsar {

namespace {

bool within_bounds(double mm) {
  return std::abs(mm) <= kMaxCoordinateMm;  // false for NaN
}

}  // namespace

void ScanSamples::add(double x_mm, double y_mm, double z_mm, bool usable_sample) {
  const bool keep = usable_sample && within_bounds(x_mm) && within_bounds(y_mm) && within_bounds(z_mm);
  x.push_back(keep ? static_cast<float>(x_mm) : 0.0F);
  y.push_back(keep ? static_cast<float>(y_mm) : 0.0F);
  z.push_back(keep ? static_cast<float>(z_mm) : 0.0F);
  usable.push_back(keep ? 1 : 0);
  const bool returned = usable_sample && std::isfinite(x_mm) && std::isfinite(y_mm) && std::isfinite(z_mm);
  too_far += returned && !keep ? 1 : 0;
}

Status ScanSamples::check_place(const std::string& name) const {
  const auto near = static_cast<std::size_t>(std::ranges::count(usable, std::uint8_t{1}));
  if (too_far <= near) {
    return {};
  }
  return bad_input(name, "lies beyond 1 km from the origin (" + std::to_string(too_far) + " samples)",
                   kMoveNear);
}

RangeGrid grid_from_samples(const ScanSamples& samples, int rows, int cols,
                            const std::vector<std::uint32_t>& sample_of_cell) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  grid.intensity.resize(samples.intensity.empty() ? 0 : grid.size());
  grid.confidence.resize(samples.confidence.empty() ? 0 : grid.size());
  grid.rgb.resize(samples.rgb.empty() ? 0 : 3 * grid.size());
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const std::size_t from = sample_of_cell.empty() ? cell : sample_of_cell[cell];
    if (from >= samples.size() || samples.usable[from] == 0) {
      continue;
    }
    grid.x[cell] = samples.x[from];
    grid.y[cell] = samples.y[from];
    grid.z[cell] = samples.z[from];
    grid.valid[cell] = 1;
    if (!samples.intensity.empty()) {
      grid.intensity[cell] = samples.intensity[from];
    }
    if (!samples.confidence.empty()) {
      grid.confidence[cell] = samples.confidence[from];
    }
    for (std::size_t k = 0; k < 3 && !samples.rgb.empty(); ++k) {
      grid.rgb[3 * cell + k] = samples.rgb[3 * from + k];
    }
  }
  normalise_intensity(grid.intensity);
  return grid;
}

PointCloud cloud_from_samples(const ScanSamples& samples) {
  PointCloud cloud;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.usable[i] == 0) {
      continue;
    }
    cloud.points.emplace_back(samples.x[i], samples.y[i], samples.z[i]);
    if (!samples.intensity.empty()) {
      cloud.intensity.push_back(samples.intensity[i]);
    }
    if (!samples.rgb.empty()) {
      cloud.rgb.insert(cloud.rgb.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    if (!samples.normals.empty()) {
      const Eigen::Vector3f n(samples.normals[3 * i], samples.normals[3 * i + 1], samples.normals[3 * i + 2]);
      cloud.normals.push_back(unit_or_zero(n));
    }
  }
  normalise_intensity(cloud.intensity);
  return cloud;
}

Eigen::Vector3f unit_or_zero(const Eigen::Vector3f& normal) {
  const float length = normal.norm();
  return std::isfinite(length) && length > 1e-6F ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::Zero();
}

std::string file_name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

void normalise_intensity(std::vector<float>& intensity) {
  float largest = 0;
  for (float& value : intensity) {
    if (!std::isfinite(value) || value < 0) {
      value = 0;
    }
    largest = std::max(largest, value);
  }
  if (largest <= 1) {
    return;
  }
  const float scale = largest <= 255 ? 255.0F : largest;
  for (float& value : intensity) {
    value /= scale;
  }
}

}  // namespace dubsar
