// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar {

/// Where the scanner looked from, in the scanner frame. Decides visibility and which side of the surface is
/// outside. A linear scanner moves by motion_per_row_mm between profiles; laser and camera are where they
/// were at row 0.
struct ScannerView {
  /// Unit vector from the scanner to the object; stands in for positions that are not known (range-grid PLY:
  /// -z).
  Eigen::Vector3d direction{0.0, 0.0, -1.0};
  std::optional<Eigen::Vector3d> laser_mm;
  std::optional<Eigen::Vector3d> camera_mm;
  Eigen::Vector3d motion_per_row_mm{0.0, 0.0, 0.0};

  /// Unit vector from point p towards the camera (or against `direction` where its position is unknown).
  [[nodiscard]] Eigen::Vector3d to_camera(const Eigen::Vector3d& p_mm, double row) const;
  [[nodiscard]] Eigen::Vector3d to_laser(const Eigen::Vector3d& p_mm, double row) const;
};

/// What the motors (and the asked-for hand turn) say about the pose: a first guess with its standard
/// deviations. Grids of one `placement` were taken without lifting the tablet: their relative pose is good to
/// sigma_*; between placements it is only as good as a hand turn, hand_sigma_*.
struct NominalPose {
  RigidTransform tablet_from_scanner;
  int placement = 0;
  double sigma_mm = 0.05;
  double sigma_rad = 0.0005;
  double hand_sigma_mm = 3.0;
  double hand_sigma_rad = 0.1;
};

/// One range image: rows × cols samples in the scanner frame, millimetres, structure of arrays, row major.
/// A cell without a return is invalid (valid[i] == 0; its coordinates mean nothing). Rows are profiles, in
/// the order in which they were scanned. Grids need not be rectilinear.
struct RangeGrid {
  int rows = 0;
  int cols = 0;
  std::vector<float> x, y, z;       ///< [rows*cols], mm
  std::vector<std::uint8_t> valid;  ///< [rows*cols], 1 where there was a return
  std::vector<float> intensity;     ///< [rows*cols] in [0,1], or empty
  std::vector<std::uint8_t> rgb;    ///< [3*rows*cols], or empty
  std::vector<float> confidence;    ///< [rows*cols] in [0,1], or empty
  double spacing_mm = 0.0;          ///< nominal lateral spacing µ; estimate_spacing_mm() where unknown
  ScannerView view;
  std::optional<NominalPose> nominal;
  double pin_tip_diameter_mm = 0.0;  ///< > 0 when fiducial pins stand in the scene
  std::int64_t timestamp_ns = 0;     ///< first profile, nanoseconds since 1970, 0 when unknown
  std::string device;                ///< the device's own id
  std::string source;                ///< the scan's original file name, or empty

  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] bool inside(int row, int col) const {
    return row >= 0 && row < rows && col >= 0 && col < cols;
  }
  [[nodiscard]] bool is_valid(int row, int col) const {
    return inside(row, col) && valid[index(row, col)] != 0;
  }
  [[nodiscard]] Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  [[nodiscard]] int row_of(std::size_t i) const {
    return static_cast<int>(i / static_cast<std::size_t>(cols));
  }
  [[nodiscard]] int col_of(std::size_t i) const {
    return static_cast<int>(i % static_cast<std::size_t>(cols));
  }

  /// Sizes all mandatory arrays to rows × cols, every cell invalid.
  void allocate(int row_count, int col_count);
  [[nodiscard]] std::size_t valid_count() const;
};

/// Nominal lateral spacing µ: the larger of the median distances between neighbouring valid samples along
/// rows and along columns, measured across the viewing direction. 0 when the grid has no two neighbours.
[[nodiscard]] double estimate_spacing_mm(const RangeGrid& grid);

/// The farthest that a point of the box is moved when what is in it goes from one pose to another; 0 for an
/// empty box.
[[nodiscard]] double displacement_mm(const Eigen::AlignedBox3f& box_mm, const RigidTransform& from,
                                     const RigidTransform& to);

/// Every stride-th row and column; spacing and motion scale with it. stride 1 copies.
[[nodiscard]] RangeGrid decimated(const RangeGrid& grid, int stride);

}  // namespace dubsar
