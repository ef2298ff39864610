// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Wedges as a numpy structured array: one row a wedge, the columns of core/wedge.h.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/tablet_sides.h"
#include "python/binding.h"

namespace dubsar::python {

namespace {

struct WedgeRow {
  std::int32_t id;
  std::int32_t body;
  double depth_point_mm[3];
  double exit_points_mm[3][3];
  double exit_points_surface_mm[3][3];
  double exit_points_extent_mm[3][3];
  double outer_vertices_mm[3][3];
  double face_normals[3][3];
  double surface_normal[3];
  std::int8_t directional_edge;
  char directional_by[24];
  double directional_margin;
  double depth_mm;
  double face_angles_rad[3];
  double opening_angles_rad[3];
  double edge_lengths_mm[3];
  double edge_slopes_rad[3];
  double face_slopes_rad[3];
  double edge_bows_mm[3];
  double volume_mm3;
  double sigma_depth_point_mm;
  double sigma_depth_mm;
  double sigma_edge_rad[3];
  double sigma_edge_slope_rad[3];
  double sigma_opening_rad[3];
  double sigma_face_angle_rad[3];
  double sigma_face_slope_rad[3];
  double sigma_length_mm[3];
  double sigma_volume_mm3;
  char side[8];
  std::int32_t line;
  std::int32_t order;
  double turn_rad;
  double reliability;
  double confidence;
  std::int32_t vertex_count;
  double intact;
  double faces_intact[3];
  bool beyond_mesh[3];
  double roundness;
  char by_hand[8];
};

void put(double (&to)[3], const Eigen::Vector3d& from) {
  std::copy_n(from.data(), 3, to);
}
void put(double (&to)[3], const std::array<double, 3>& from) {
  std::ranges::copy(from, to);
}
void put(double (&to)[3][3], const std::array<Eigen::Vector3d, 3>& from) {
  for (std::size_t k = 0; k < 3; ++k) {
    put(to[k], from[k]);
  }
}
/// numpy reads such a text to its first zero, or to its end.
template <std::size_t N>
void put(char (&to)[N], std::string_view from) {
  std::copy_n(from.begin(), std::min(from.size(), N), to);
}

WedgeRow row_of(const Wedge& wedge) {
  WedgeRow row{};
  row.id = wedge.id;
  row.body = wedge.place.body;
  put(row.depth_point_mm, wedge.depth_point_mm);
  put(row.exit_points_mm, wedge.exit_points_mm);
  put(row.exit_points_surface_mm, wedge.exit_points_surface_mm);
  put(row.exit_points_extent_mm, wedge.exit_points_extent_mm);
  put(row.outer_vertices_mm, wedge.outer_vertices_mm);
  put(row.face_normals, wedge.face_normals);
  put(row.surface_normal, wedge.surface_normal);
  row.directional_edge = static_cast<std::int8_t>(wedge.directional_edge);
  put(row.directional_by, kDirectionalByNames[static_cast<std::size_t>(wedge.directional_by)]);
  row.directional_margin = wedge.directional_margin;
  row.depth_mm = wedge.depth_mm;
  put(row.face_angles_rad, wedge.face_angles_rad);
  put(row.opening_angles_rad, wedge.opening_angles_rad);
  put(row.edge_lengths_mm, wedge.edge_lengths_mm);
  put(row.edge_slopes_rad, wedge.edge_slopes_rad);
  put(row.face_slopes_rad, wedge.face_slopes_rad);
  put(row.edge_bows_mm, wedge.edge_bows_mm);
  row.volume_mm3 = wedge.volume_mm3;
  row.sigma_depth_point_mm = wedge.sigma.depth_point_mm;
  row.sigma_depth_mm = wedge.sigma.depth_mm;
  put(row.sigma_edge_rad, wedge.sigma.edge_rad);
  put(row.sigma_edge_slope_rad, wedge.sigma.edge_slope_rad);
  put(row.sigma_opening_rad, wedge.sigma.opening_rad);
  put(row.sigma_face_angle_rad, wedge.sigma.face_angle_rad);
  put(row.sigma_face_slope_rad, wedge.sigma.face_slope_rad);
  put(row.sigma_length_mm, wedge.sigma.length_mm);
  row.sigma_volume_mm3 = wedge.sigma.volume_mm3;
  if (wedge.place.side) {
    put(row.side, to_string(*wedge.place.side));
  }
  row.line = wedge.place.line;
  row.order = wedge.place.order;
  row.turn_rad = wedge.place.turn_rad;
  row.reliability = wedge.reliability;
  row.confidence = wedge.confidence;
  row.vertex_count = wedge.vertex_count;
  row.intact = wedge.intact;
  put(row.faces_intact, wedge.faces_intact);
  std::ranges::copy(wedge.beyond_mesh, row.beyond_mesh);
  row.roundness = wedge.roundness;
  put(row.by_hand, kByHandNames[static_cast<std::size_t>(wedge.by_hand)]);
  return row;
}

}  // namespace

py::array wedge_rows(const std::vector<Wedge>& wedges) {
  py::array_t<WedgeRow> out(static_cast<py::ssize_t>(wedges.size()));
  std::ranges::transform(wedges, out.mutable_data(), row_of);
  return out;
}

void bind_wedge_rows() {
  PYBIND11_NUMPY_DTYPE(WedgeRow, id, body, depth_point_mm, exit_points_mm, exit_points_surface_mm,
                       exit_points_extent_mm, outer_vertices_mm, face_normals, surface_normal,
                       directional_edge, directional_by, directional_margin, depth_mm, face_angles_rad,
                       opening_angles_rad, edge_lengths_mm, edge_slopes_rad, face_slopes_rad, edge_bows_mm,
                       volume_mm3, sigma_depth_point_mm, sigma_depth_mm, sigma_edge_rad, sigma_edge_slope_rad,
                       sigma_opening_rad, sigma_face_angle_rad, sigma_face_slope_rad, sigma_length_mm,
                       sigma_volume_mm3, side, line, order, turn_rad, reliability, confidence, vertex_count,
                       intact, faces_intact, beyond_mesh, roundness, by_hand);
}

}  // namespace dubsar::python
