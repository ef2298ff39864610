// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_numbering.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace dubsar {

void number_from_directional_edge(WedgeCandidate* candidate) {
  Wedge& wedge = candidate->wedge;
  const int first = wedge.directional_edge;
  if (first == 0) {
    return;
  }
  const auto turn = [first](auto&... of_three) {
    (std::ranges::rotate(of_three, of_three.begin() + first), ...);
  };
  turn(wedge.exit_points_mm, wedge.exit_points_surface_mm, wedge.exit_points_extent_mm,
       wedge.outer_vertices_mm, wedge.face_normals);
  turn(wedge.face_angles_rad, wedge.opening_angles_rad, wedge.edge_lengths_mm, wedge.edge_slopes_rad,
       wedge.face_slopes_rad, wedge.edge_bows_mm);
  turn(wedge.sigma.edge_rad, wedge.sigma.edge_slope_rad, wedge.sigma.opening_rad, wedge.sigma.face_angle_rad,
       wedge.sigma.face_slope_rad, wedge.sigma.length_mm);
  turn(wedge.faces_intact, wedge.beyond_mesh, candidate->coverage);
  for (std::int8_t& face : candidate->faces) {
    face = static_cast<std::int8_t>((face + 3 - first) % 3);
  }
  wedge.directional_edge = 0;
}

}  // namespace dubsar
