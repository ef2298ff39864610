// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/ring_surroundings.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What is read on the rings: the surface's heights over the tangent plane tell the shape of any object; its
/// relief and its tone (relief.h) tell what is on it where the shape is the same all over.
enum class RingContent { kShape, kRelief, kTone };

/// Of rings × sectors.
using RingHeights = std::array<float, RingSurroundings::kCells>;

struct RingDescriptorOptions {
  int keypoints = 1200;
  std::array<double, 2> radius{0.06, 0.13};  ///< of the scale of the object
  double least_filled = 0.7;                 ///< share of a descriptor's cells that must hold samples
  int matches_per_keypoint = 3;
};

/// Shape around a point as heights over its tangent plane on rings at two radii. The magnitudes of the
/// Fourier coefficients along each ring do not depend on how the surface is turned about the normal; their
/// phases give the turn back once two points are matched, so that one match is a whole pose.
class RingDescriptors {
 public:
  static constexpr int kRings = RingSurroundings::kRings;
  static constexpr int kHarmonics = 5;  ///< 0 … 4
  static constexpr int kSectors = RingSurroundings::kSectors;
  static constexpr int kScales = 2;
  static constexpr int kLength = kScales * kRings * kHarmonics;

  RingDescriptors() = default;
  /// Descriptors of each of the contents, at keypoints spread over the medium level of the scan; `scale_mm`
  /// must be the same for all scans to be matched.
  [[nodiscard]] static std::vector<RingDescriptors> make(const ScanSurface& surface, double scale_mm,
                                                         std::span<const RingContent> contents,
                                                         const RingDescriptorOptions& options);

  [[nodiscard]] std::size_t size() const { return keypoints_.size(); }
  [[nodiscard]] const SurfaceSample& keypoint(std::size_t i) const { return keypoints_[i]; }

  struct Match {
    int source = 0;
    int target = 0;
    float distance = 0;  ///< between the descriptors, relative to their size
  };
  /// The nearest target descriptors of each source keypoint, best matches first.
  [[nodiscard]] static std::vector<Match> match(const RingDescriptors& source, const RingDescriptors& target,
                                                const RingDescriptorOptions& options);
  /// target_from_source that lays keypoint m.source onto m.target, normals together, turned as the phases
  /// say.
  [[nodiscard]] static RigidTransform pose_of(const RingDescriptors& source, const RingDescriptors& target,
                                              const Match& m);

 private:
  using Coefficients = std::array<std::complex<float>, kScales * kRings * kHarmonics>;

  static void set_scale(Coefficients& coefficients, int scale, const RingHeights& heights);
  void set_magnitudes();

  std::vector<SurfaceSample> keypoints_;
  std::vector<Eigen::Vector3f> tangents_;  ///< where the sectors start
  std::vector<Coefficients> coefficients_;
  Eigen::MatrixXf magnitudes_;  ///< kLength × keypoints
};

}  // namespace dubsar
