// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/body.h"
#include "sim/press_index.h"
#include "sim/seal.h"
#include "sim/tablet.h"

namespace dubsar::sim {

/// The undamaged surface over one base point.
struct ClayPoint {
  double height_mm = 0;  ///< along the base normal
  SurfaceKind kind = SurfaceKind::kBody;
  std::int32_t wedge = -1;  ///< impression that made the surface here, or -1
  int face = -1;            ///< which of its faces
  double hollow_mm = 0;     ///< height as that impression left it, before later ones heaped clay on it
  int pressed_count = 0;    ///< impressions that made the surface here at some time, the last ones of them
  std::array<std::uint32_t, 8> pressed{};
};

/// The clay as the scribe left it: grain, seal, and wedges in writing order. Immutable; safe from many
/// threads.
class Clay {
 public:
  Clay(const TabletOptions& options, const TabletBody& body);

  [[nodiscard]] ClayPoint at(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const;
  [[nodiscard]] const std::vector<Impression>& impressions() const { return impressions_; }
  /// The impression whose depth point lies within radius_mm under the base point p, nearest first; or -1.
  [[nodiscard]] std::int32_t depth_point_near(const Eigen::Vector3d& p, double radius_mm) const;

 private:
  [[nodiscard]] double grain_mm(const Eigen::Vector3d& p) const;

  TabletOptions options_;
  std::vector<Impression> impressions_;
  PressIndex index_;
  SealBand seal_;
};

}  // namespace dubsar::sim
