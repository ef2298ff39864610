// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mesh_json.h"

#include "core/units.h"

namespace dubsar {

nlohmann::ordered_json mesh_report_json(const MeshReport& report) {
  nlohmann::ordered_json json{
      {"vertices", report.vertices},
      {"faces", report.faces},
      {"manifold", report.is_manifold()},
      {"closed", report.is_closed()},
      {"components", report.components},
      {"largest_component_faces", report.largest_component},
      {"boundary_loops", report.boundary_loops},
      {"boundary_edges", report.boundary_edges},
      {"boundary_length_mm", report.boundary_length_mm},
      {"longest_boundary_loop_mm", report.longest_boundary_loop_mm},
      {"non_manifold_edges", report.non_manifold_edges},
      {"non_manifold_vertices", report.non_manifold_vertices},
      {"inconsistent_faces", report.inconsistent_faces},
      {"degenerate_faces", report.degenerate_faces},
      {"duplicate_faces", report.duplicate_faces},
      {"repeated_faces", report.repeated_faces},
      {"self_intersections", report.self_intersections},
      {"unreferenced_vertices", report.unreferenced_vertices},
      {"share_below_10_deg", report.thin_share},
      {"min_angle_deg", deg_from_rad(report.min_angle_rad)},
      {"area_mm2", report.area_mm2},
  };
  if (report.box.isEmpty()) {
    json["size_mm"] = {0, 0, 0};
  } else {
    const Eigen::Vector3d size = report.box.max().cast<double>() - report.box.min().cast<double>();
    json["size_mm"] = {size.x(), size.y(), size.z()};
  }
  return json;
}

}  // namespace dubsar
