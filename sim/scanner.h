// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/job.h"
#include "core/mesh.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/rig.h"
#include "sim/scene.h"

namespace dubsar::sim {

/// A laser-triangulation scanner with linear motion. The laser stands at (0, row, standoff) and fans out in
/// x, the camera baseline_mm farther along y, both looking at the centre of the measuring volume.
struct ScannerOptions {
  double spacing_mm = 0.1;  ///< lateral spacing µ at the centre of the volume
  double noise_mm = 0.02;   ///< standard deviation along the laser's ray at normal incidence
  double standoff_mm = 250;
  double baseline_mm = 110;  ///< triangulation angle about 24°
  double field_x_mm = 70;
  double field_y_mm = 70;
  double depth_range_mm = 70;
  double incidence_gain = 0.6;   ///< noise grows by 1 + gain·(1/cos - 1)
  double speckle_share = 0.5;    ///< of the noise's variance, correlated along the profile
  double speckle_length = 2.5;   ///< its correlation length in samples
  double grazing_cosine = 0.13;  ///< no return when laser or camera sees the surface flatter than this
  double dark_signal = 0.06;     ///< albedo·cosine at which half of the returns are lost
  double dropout = 0.0005;       ///< share of returns lost for no reason
  double outlier = 0.0002;       ///< share of returns put elsewhere (reflections)
  double mixed_pixel = 0.3;      ///< share of samples at a depth edge that fall between its sides
  double quantum_mm = 0.002;     ///< depth step of the stripe detector
  double margin_mm = 3;          ///< how far around the scene rows and columns are scanned
  std::uint64_t seed = 1;
};

/// A scanner whose measuring volume takes a tablet of this size on any side, with the same triangulation
/// angle; the default one where that is big enough.
[[nodiscard]] ScannerOptions scanner_for(const Eigen::Vector3d& size_mm, double spacing_mm, double noise_mm);

/// Rows, columns and geometry of a scan that is about to be made.
struct ScanLayout {
  int rows = 0;
  int cols = 0;
  double spacing_mm = 0;
  ScannerView view;
  double first_x_mm = 0;  ///< of column 0, in the plane z = 0
  double first_y_mm = 0;  ///< of row 0
};

/// One profile, as the device sends it. The spans live during the call only.
struct ProfileRow {
  int row = 0;
  std::span<const float> x, y, z, intensity;
  std::span<const std::uint8_t> valid;
};

/// Takes one profile; false stops the scan.
using RowSink = std::function<bool(const ProfileRow&)>;

class TriangulationScanner {
 public:
  explicit TriangulationScanner(const ScannerOptions& options) : options_(options) {}

  [[nodiscard]] const ScannerOptions& options() const { return options_; }
  /// The part of the field in which the scene can appear; no rows when none of it can.
  [[nodiscard]] ScanLayout layout(const Scene& scene, const RigidTransform& tablet_from_scanner) const;
  /// Scans row after row, in order. scan_number tells the noise of two scans of one pose apart. Errors:
  /// kCancelled when the job or the sink stops it.
  [[nodiscard]] Status scan(const Scene& scene, const RigidTransform& tablet_from_scanner,
                            std::uint64_t scan_number, const RowSink& sink, JobContext& job) const;
  /// The same as a whole grid (nominal pose and source left empty; the device is "sim").
  [[nodiscard]] Result<RangeGrid> scan_grid(const Scene& scene, const RigidTransform& tablet_from_scanner,
                                            std::uint64_t scan_number, JobContext& job) const;
  /// View of the scanner at the middle row, for Rig.
  [[nodiscard]] ScannerView rig_view() const;

 private:
  ScannerOptions options_;
};

/// An empty grid of a layout, to be filled row by row; its device is "sim", so that whatever comes of it is
/// told as made up.
[[nodiscard]] RangeGrid grid_of(const ScanLayout& layout);

}  // namespace dubsar::sim
