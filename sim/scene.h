// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "core/mesh_query.h"
#include "sim/tablet.h"

namespace dubsar::sim {

/// One fiducial pin in the tablet frame: a ball at the tip, a cone that widens along the arm.
struct Pin {
  int label = 0;
  Eigen::Vector3d tip_mm{0, 0, 0};  ///< centre of the tip ball
  Eigen::Vector3d arm{0, 0, 1};     ///< unit, from the tip along the arm
  double tip_radius_mm = 0.5;
  double arm_radius_mm = 1.5;  ///< at the arm's far end
  double arm_length_mm = 30;
};

/// First hit of a ray with a pin within [near_mm, far_mm].
struct PinHit {
  double distance_mm = 0;
  Eigen::Vector3d normal{0, 0, 1};
};
[[nodiscard]] std::optional<PinHit> hit_pin(const Pin& pin, const Eigen::Vector3d& origin_mm,
                                            const Eigen::Vector3d& direction, double near_mm, double far_mm);

/// Half space below a plane: n·p < offset is hidden.
struct Support {
  Eigen::Vector3d normal{0, 0, 1};
  double offset_mm = 0;
};

/// What stands before the scanner, in the tablet frame. Refers to the tablet and its query: keep both alive.
struct Scene {
  const SimTablet* tablet = nullptr;
  const MeshQuery* query = nullptr;
  std::vector<Pin> pins;           ///< those that stand in this scan
  std::optional<Support> support;  ///< matt black: gives no return, hides what lies behind
};

/// What a ray meets first.
struct SceneHit {
  double distance_mm = 0;
  Eigen::Vector3d normal{0, 0, 1};
  double albedo = 0;  ///< 0: the support
  bool pin = false;
};
[[nodiscard]] std::optional<SceneHit> first_hit(const Scene& scene, const Eigen::Vector3d& origin_mm,
                                                const Eigen::Vector3d& direction, double far_mm);
/// True when anything stands between a and b; within margin_mm of either end nothing counts.
[[nodiscard]] bool blocked(const Scene& scene, const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm,
                           double margin_mm);

}  // namespace dubsar::sim
