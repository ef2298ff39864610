// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "analysis/wedge_patch.h"
#include "core/result.h"

namespace dubsar {

/// One face of a wedge: normal·p = offset in the patch's frame, the normal out of the clay.
struct FacePlane {
  Eigen::Vector3d normal{0, 0, 1};
  double offset_mm = 0;
  Eigen::Vector3d middle{0, 0, 0};  ///< of its triangles
  double rms_mm = 0;                ///< of its triangles' corners' distances
  double weight = 0;                ///< area times reliability summed over its triangles, mm²
  std::uint32_t count = 0;          ///< of its triangles
  double sigma_rad = 0;             ///< standard deviation of the normal's direction, the worse axis
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const { return normal.dot(p) - offset_mm; }
  /// Height of the plane over the patch's z = 0 at p's x and y; steep planes are cut at 87 degrees.
  [[nodiscard]] double height_at(const Eigen::Vector3d& p) const {
    const double climb = normal.z() > 0.05 ? normal.z() : 0.05;
    return (offset_mm - normal.x() * p.x() - normal.y() * p.y()) / climb;
  }
};

/// The three faces of a pit. Counter-clockwise seen from outside the clay; face k lies between inner edges k
/// and k + 1.
struct WedgeFaces {
  std::array<FacePlane, 3> plane{};
  std::vector<std::int8_t> face;          ///< [N] face of each vertex of the patch, or -1
  Eigen::Vector3d depth_point{0, 0, 0};   ///< where the planes meet
  std::array<Eigen::Vector3d, 3> edge{};  ///< unit, out of the depth point, rising
};

/// Limits of the search for faces; lengths follow the patch's depth and spacing.
struct FaceOptions {
  double normal_gate_deg = 45;    ///< a triangle's normal against its face's
  double min_face_share = 0.015;  ///< of the wedge's area
  std::uint32_t min_face_triangles = 3;
  double min_opening_deg = 25;
  double max_opening_deg = 165;
};

/// Three faces of the wedge whose depth point is near the patch's lowest vertex (seed 000, 3.4): normals of
/// its surroundings clustered, weighted by reliability; planes fitted to the clusters and the clusters to the
/// planes in turn, over ever wider surroundings; spikes and small parts discarded; at last the planes fitted
/// again away from their borders (refit_planes()). Where the patch holds no such pit, what is wrong is said
/// instead.
[[nodiscard]] std::expected<WedgeFaces, std::string> find_faces(const WedgePatch& patch,
                                                                const FaceOptions& options);

}  // namespace dubsar
