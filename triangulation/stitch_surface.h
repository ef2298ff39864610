// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid_lookup.h"
#include "core/job.h"
#include "core/placed_scan.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/lattice.h"
#include "triangulation/packed_normal.h"
#include "triangulation/small_motion.h"

namespace dubsar {

struct StitchSurfaceOptions {
  GridTriangulationOptions grid;
  /// Samples from the rim of a scan over which its wish to be primary rises to full: a rim is seldom the best
  /// view.
  int rise_samples = 6;
  /// Radius of the mean over which incidence is compared between scans, samples: the primary scan changes
  /// along a line, not from sample to sample with the noise of the normals.
  int incidence_radius_samples = 15;
};

inline constexpr int kMostRim = 32;

/// Bits of StitchSurface::usable.
enum UsableBit : std::uint8_t {
  kUsable = 1,        ///< the sample is a corner of a triangle of its own grid
  kUsableSparse = 2,  ///< and sparse
};

/// How a scan's pose seems to be off.
struct Misplacement {
  SmallMotion back;    ///< takes the scan to where the others have it; none: the pose is not known to be off
  double left_mm = 0;  ///< standard deviation in space, as PlacedScan::sigma_mm, of where that takes it
  double together_mm = 0;  ///< the same of what linked scans share once one moves, which no overlap tells
};

/// One placed scan made ready for stitching: its samples in the model frame, the triangles of its grid, and
/// how far each sample is to be trusted. Arrays are [rows*cols] of the grid where nothing else is said. It
/// holds all that stitching needs of a scan, 27 bytes a sample, 30 with colours: the grid itself may go.
struct StitchSurface {
  int id = 0;
  double told_pose_sigma_mm = 0;  ///< as it came
  double pose_sigma_mm = 0;       ///< that, or what the overlaps with other scans say of `back`
  bool is_fixed = false;          ///< `back` stays none
  /// From where its pose puts it to where the other scans have it: there it lies in the mesh. None where its
  /// pose is not known to be off.
  SmallMotion back;
  float together_variance_mm2 = 0;  ///< along any direction, of Misplacement::together_mm
  double spacing_mm = 0;
  double noise_mm = 0;  ///< of a sample along the view
  /// × 1 / weight(): the variance of a sample along the normal, mm², by its noise alone.
  float variance_of_weight = 0;
  bool mirrored = false;
  ScannerView view;                                  ///< in the model frame
  std::vector<Eigen::Vector3f> points;               ///< model frame, mm
  std::vector<PackedNormal> normals;                 ///< model frame, out of the clay; zero where undefined
  std::vector<std::uint8_t> usable;                  ///< UsableBit
  std::vector<std::uint8_t> cells;                   ///< CellBit codes
  std::vector<std::uint16_t> reliability_code;       ///< × kCodes
  std::vector<std::uint16_t> weight_code;            ///< × kCodes, of weight_of_best
  float weight_of_best = 0;                          ///< 1 / mm²
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< sRGB as the scanner gave them, or empty
  float pose_share = 1;                              ///< of weight(): what the error of the pose leaves of it
  std::vector<std::uint8_t> rim;  ///< samples to the rim of the triangulated area: 1 on it, at most kMostRim
  Eigen::AlignedBox3f box;        ///< of the usable samples, model frame
  RigidTransform scanner_from_model;
  std::unique_ptr<GridLookup> lookup;  ///< of every fourth usable sample, scanner frame
  Lattice lattice;
  std::vector<std::int32_t> node_sample;  ///< by node: the usable sample nearest to its middle, or -1
  std::vector<float> score;               ///< by node: how much this scan wants to be primary there

  static constexpr float kCodes = 65535.0F;

  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const { return normals[i].unpack(); }
  [[nodiscard]] bool is_sparse(std::size_t i) const { return (usable[i] & kUsableSparse) != 0; }
  /// Of the sample alone, in [0,1]: cos² of the incidence × confidence.
  [[nodiscard]] float reliability(std::size_t i) const {
    return static_cast<float>(reliability_code[i]) * (1.0F / kCodes);
  }
  /// For averaging, 1 / mm²: inverse to the variance along the normal, which hardly grows with the incidence
  /// (the noise along the view does, its part along the normal shrinks). Less at the rim, little for sparse
  /// samples; > 0 if usable. It takes in what a surface through samples µ apart may be off by, not the pose:
  /// × pose_share.
  [[nodiscard]] float weight(std::size_t i) const {
    return static_cast<float>(weight_code[i]) * (weight_of_best / kCodes);
  }
  /// The pose's error is one of displacement in space; a third of its square lies along any one direction.
  [[nodiscard]] float pose_variance_mm2() const;
  /// From `points` to the mesh, but for averaging.
  [[nodiscard]] Eigen::Vector3f moved_back(const Eigen::Vector3f& p_mm) const {
    return back.is_none() ? p_mm : Eigen::Vector3f(p_mm + back.at(p_mm));
  }
  /// The way there; so small a turn is the same from either end.
  [[nodiscard]] Eigen::Vector3f as_posed(const Eigen::Vector3f& p_mm) const {
    return back.is_none() ? p_mm : Eigen::Vector3f(p_mm - back.at(p_mm));
  }
  /// What the overlaps say; where they say nothing, what was told counts. False where that changes nothing.
  bool take_misplacement(const Misplacement& misplacement);
  /// Where its cells are; it holds no normals.
  [[nodiscard]] GridSurface surface() const {
    return {lattice.rows, lattice.cols, spacing_mm, points, {}, view};
  }
};

/// Never fails: a scan without a triangle has no usable sample. Keeps no reference to the grid or its flags.
/// Of a job that is cancelled it is no good.
[[nodiscard]] StitchSurface make_scan_surface(const PlacedScan& scan, const StitchSurfaceOptions& options,
                                              const JobContext& job = {});

}  // namespace dubsar
