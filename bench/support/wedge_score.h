// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/vertex_graph.h"
#include "core/wedge.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// Found wedges on fracture faces; remains of true wedges are wedges.
struct FractureScore {
  int right_on = 0, false_on = 0;              ///< more than half of their vertices lie on a fracture
  int right_touching = 0, false_touching = 0;  ///< some of their vertices do, or border one
  std::vector<double> depth_um;  ///< errors of the depths of those that touch one, so far intact as others
  void add(const FractureScore& other);
};

/// Found wedges against true ones, over any number of tablets.
struct WedgeScore {
  int right = 0;  ///< found wedges that are true ones, at least so far intact
  int false_ones = 0;
  int missed = 0;   ///< true wedges, at least so far intact, that were not found
  int ignored = 0;  ///< found ones that are remains of true ones
  int directional_right = 0;
  std::vector<double> depth_point_um, depth_um, edge_deg, opening_deg;
  std::vector<double> false_confidence, right_confidence;
  FractureScore fracture;
  /// Errors in the standard deviations that the wedge itself states.
  std::vector<double> depth_point_sigmas, depth_sigmas, edge_sigmas, opening_sigmas, length_sigmas,
      face_angle_sigmas;
  /// Found less true: what does not average away.
  std::vector<double> depth_off_um, length_off_um, opening_off_deg, face_angle_off_deg;
  [[nodiscard]] double precision() const;
  [[nodiscard]] double recall() const;
  [[nodiscard]] double f1() const;
  void add(const WedgeScore& other);
};

struct ScoreOptions {
  double least_intact = 0.6;
  double reach_mm = 0.4;  ///< between the depth points of a pair
};

/// One to one, nearest depth points first. `pair`: [found] index of the true wedge, or -1.
[[nodiscard]] WedgeScore score_wedges(const std::vector<Wedge>& found, const std::vector<Wedge>& truth,
                                      const ScoreOptions& options, std::vector<int>* pair = nullptr);

/// Of those that score_wedges() has paired. `wedge_of`: [V] the found wedge that a vertex belongs to, or -1;
/// `kinds`: [V] what truly made the surface there; `pair`: as score_wedges() fills it.
[[nodiscard]] FractureScore score_fractures(const VertexGraph& graph,
                                            const std::vector<std::int32_t>& wedge_of,
                                            const std::vector<sim::SurfaceKind>& kinds,
                                            const std::vector<int>& pair, const std::vector<Wedge>& found,
                                            const std::vector<Wedge>& truth, const ScoreOptions& options);

[[nodiscard]] double median(std::vector<double> values);

}  // namespace dubsar::bench
