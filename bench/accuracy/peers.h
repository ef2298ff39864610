// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "bench/support/pair_cases.h"

namespace dubsar::bench {

/// Largest distances of a pair, mm, stage by stage: from far to close, and all in one go.
inline constexpr double kThreeStages[] = {20.0, 5.0, 1.5};
inline constexpr double kOneStage[] = {10.0};

/// Normals of a scan from its grid, [samples], with its points: what the peers are given.
struct PeerPoints {
  std::vector<Eigen::Vector3d> points_mm, normals;
};
[[nodiscard]] PeerPoints peer_points(const RangeGrid& grid);

/// Point-to-plane and generalized ICP at full resolution. Only where the library was found (see
/// bench/CMakeLists.txt). The scans must outlive the methods.
[[nodiscard]] std::vector<PairMethod> pcl_methods(const std::vector<PublishedScan>& scans);
[[nodiscard]] std::vector<PairMethod> open3d_methods(const std::vector<PublishedScan>& scans);

}  // namespace dubsar::bench
