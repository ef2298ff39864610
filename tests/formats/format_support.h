// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar::testing {

/// A folder of its own for one test, gone with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "dubsar-formats-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

/// A curved patch with holes, awkward numbers and every optional field.
inline RangeGrid sample_grid(int rows, int cols, bool everything) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  Random random(7);
  grid.intensity.resize(everything ? grid.size() : 0);
  grid.confidence.resize(everything ? grid.size() : 0);
  grid.rgb.resize(everything ? 3 * grid.size() : 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (random.below(7) == 0) {
      continue;
    }
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    grid.valid[i] = 1;
    grid.x[i] = static_cast<float>(0.1 * col + 1e-3 * random.normal());
    grid.y[i] = static_cast<float>(0.1 * row + 1e-3 * random.normal());
    grid.z[i] = static_cast<float>(std::sin(0.3 * col) + 0.02 * random.normal());
    if (everything) {
      grid.intensity[i] = static_cast<float>(random.uniform());
      grid.confidence[i] = static_cast<float>(random.uniform());
      for (std::size_t k = 0; k < 3; ++k) {
        grid.rgb[3 * i + k] = static_cast<std::uint8_t>(random.below(256));
      }
    }
  }
  grid.spacing_mm = 0.1;
  if (everything) {
    grid.view.direction = Eigen::Vector3d(0.1, -0.2, -0.97).normalized();
    grid.view.laser_mm = Eigen::Vector3d(1.0 / 3.0, 2, 250);
    grid.view.camera_mm = Eigen::Vector3d(-116.5, 0.7, 1e-17);
    grid.view.motion_per_row_mm = {0, 0.1, 0};
    grid.pin_tip_diameter_mm = 1.05;
    grid.timestamp_ns = 1234567890123456789;
    grid.device = "sim:0 with blanks";
    grid.source = "scan_007.ply";
  }
  return grid;
}

/// Equality to the bit, wherever cells are valid.
inline void expect_same_grid(const RangeGrid& a, const RangeGrid& b) {
  ASSERT_EQ(a.rows, b.rows);
  ASSERT_EQ(a.cols, b.cols);
  ASSERT_EQ(a.valid, b.valid);
  ASSERT_EQ(a.intensity.size(), b.intensity.size());
  ASSERT_EQ(a.confidence.size(), b.confidence.size());
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.valid[i] == 0) {
      continue;
    }
    ASSERT_EQ(bits(a.x[i]), bits(b.x[i])) << i;
    ASSERT_EQ(bits(a.y[i]), bits(b.y[i])) << i;
    ASSERT_EQ(bits(a.z[i]), bits(b.z[i])) << i;
    if (!a.intensity.empty()) {
      ASSERT_EQ(bits(a.intensity[i]), bits(b.intensity[i])) << i;
    }
    if (!a.confidence.empty()) {
      ASSERT_EQ(bits(a.confidence[i]), bits(b.confidence[i])) << i;
    }
    for (std::size_t k = 0; k < 3 && !a.rgb.empty(); ++k) {
      ASSERT_EQ(a.rgb[3 * i + k], b.rgb[3 * i + k]) << i;
    }
  }
  EXPECT_EQ(a.spacing_mm, b.spacing_mm);
  EXPECT_EQ(a.view.direction, b.view.direction);
  EXPECT_EQ(a.view.laser_mm, b.view.laser_mm);
  EXPECT_EQ(a.view.camera_mm, b.view.camera_mm);
  EXPECT_EQ(a.view.motion_per_row_mm, b.view.motion_per_row_mm);
  EXPECT_EQ(a.pin_tip_diameter_mm, b.pin_tip_diameter_mm);
  EXPECT_EQ(a.timestamp_ns, b.timestamp_ns);
  EXPECT_EQ(a.device, b.device);
}

/// The one line of an error, or "no error".
template <class T>
std::string line_of(const Result<T>& result) {
  return result ? "no error" : result.error().line();
}

}  // namespace dubsar::testing
