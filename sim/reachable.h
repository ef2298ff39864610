// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "sim/scanner.h"
#include "sim/scene.h"

namespace dubsar::sim {

struct ReachOptions {
  std::size_t samples = 20000;  ///< points spread evenly over the area
  int directions = 300;         ///< from which the tablet is looked at, spread over the whole sphere
  int rolls = 12;               ///< turns of the scanner about its axis, each direction
  double max_slope_deg = 70.5;  ///< beyond it neighbours lie more than 3µ apart (seed 001, 3.3)
  std::uint64_t seed = 1;
};

/// Spreads `samples` points evenly over a surface, with the normals of their faces; each stands for the same
/// area.
void spread_over(const Mesh& mesh, std::size_t samples, std::uint64_t seed,
                 std::vector<Eigen::Vector3f>* points, std::vector<Eigen::Vector3f>* normals);

/// Which parts of the true surface any pose can see well: laser and camera unobstructed, both less flat than
/// the limit. Since the tablet can be laid on any side and turned, every direction is a pose of the rig.
struct Reach {
  std::vector<Eigen::Vector3f> points;   ///< [N], each stands for the same area
  std::vector<Eigen::Vector3f> normals;  ///< [N]
  std::vector<std::uint8_t> reachable;   ///< [N]
  double share = 0;                      ///< of the area that is reachable
};
/// [N], 1 where the point can be seen well from somewhere. Errors: kCancelled.
[[nodiscard]] Result<std::vector<std::uint8_t>> reachable_points(
    const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3f>& normals,
    const MeshQuery& query, const ScannerOptions& scanner, const ReachOptions& options, JobContext& job);
[[nodiscard]] Result<Reach> reachable_surface(const SimTablet& tablet, const MeshQuery& query,
                                              const ScannerOptions& scanner, const ReachOptions& options,
                                              JobContext& job);

}  // namespace dubsar::sim
