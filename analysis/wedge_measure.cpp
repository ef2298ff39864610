// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"

namespace dubsar {

namespace {

/// An inner edge that has not met the surface after so many depths does not meet it.
constexpr double kReachDepths = 30.0;

/// A rim is at the free surface within so many depths.
constexpr double kLevelDepths = 0.2;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Longest or flattest, and by how much (facts.md): both rest on the edges' slopes where exits are hidden.
void choose_directional(Wedge* wedge) {
  const auto lead = [](const std::array<double, 3>& key) {  // the largest, and its lead over the next
    std::size_t first = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      first = key[k] > key[first] ? k : first;
    }
    const double next = std::max(key[(first + 1) % 3], key[(first + 2) % 3]);
    return std::pair{first, key[first] > 0 ? (key[first] - next) / key[first] : 0.0};
  };
  std::array<double, 3> length{};
  std::array<double, 3> flatness{};
  for (std::size_t k = 0; k < 3; ++k) {
    length[k] = (wedge->exit_points_surface_mm[k] - wedge->depth_point_mm).norm();
    flatness[k] = 1.0 / std::max(wedge->edge_slopes_rad[k], 1e-3);
  }
  const auto [longest, by_length] = lead(length);
  const auto [flattest, by_slope] = lead(flatness);
  const bool length_decides = by_length > by_slope;
  wedge->directional_edge = static_cast<int>(length_decides ? longest : flattest);
  wedge->directional_margin = std::max(by_length, by_slope);
  wedge->directional_by = longest == flattest ? DirectionalBy::kBoth
                          : length_decides    ? DirectionalBy::kLongest
                                              : DirectionalBy::kFlattest;
}

/// What the fits say of themselves takes every few vertices for independent. On scanned and stitched meshes
/// neighbours err together: so many times as large is what the errors on simulated tablets are
/// (dubsar-wedges prints them against these).
constexpr double kPointTogether = 1.7;
constexpr double kEdgeTogether = 1.8;
constexpr double kPlaneTogether = 2.4;
/// Where scans lay few samples across an impression, stitching rounds what lies between them: beyond so many
/// spacings to a depth the sigmas grow, as the errors do. Fitted to simulated tablets scanned at µ 0.05,
/// 0.075 and 0.1 mm, with true poses and with ones that are 20 µm off; of edges and depth points to sessions
/// at µ 0.1 mm (noise 5 and 20 µm, seeds 1 and 3).
constexpr double kFineSpacings = 0.15;
constexpr double kCoarseGrowth = 4.0;
constexpr double kCoarseFaceGrowth = 1.5;
/// A face's direction is not known better: its clay is not quite even, and where others were pressed beside
/// it neither is it a plane.
constexpr double kFaceRad = 0.006;
/// Of the free surface above an impression, which nobody has seen: where it lies, at least and as a share of
/// the depth (its dam grows with a wedge, and so does what bridging it leaves open), and which way it looks.
constexpr double kSurfaceMm = 0.02;
constexpr double kSurfaceShare = 0.05;
constexpr double kSurfaceRad = 0.013;

void note_sigmas(const WedgeFaces& faces, const InnerEdges& edges, double spacing_mm, ExitDefinition exits,
                 Wedge* wedge) {
  WedgeSigma& sigma = wedge->sigma;
  const double depth = std::max(wedge->depth_mm, 0.01);
  const double beyond = std::max(0.0, spacing_mm / depth - kFineSpacings);
  const double coarse = 1.0 + kCoarseGrowth * beyond;
  const auto face_sigma = [&](std::size_t k) {
    return std::hypot((1.0 + kCoarseFaceGrowth * beyond) * kPlaneTogether * faces.plane[k].sigma_rad,
                      kFaceRad);
  };
  sigma.depth_point_mm = coarse * kPointTogether * edges.depth_point_sigma_mm;
  sigma.depth_mm = std::hypot(sigma.depth_point_mm / std::sqrt(3.0),
                              std::max(kSurfaceMm, kSurfaceShare * wedge->depth_mm));
  double relative = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const InnerEdge& edge = edges.edge[k];
    const double rise = std::max(edge.direction.z(), 0.03);
    sigma.edge_rad[k] = coarse * kEdgeTogether * edge.sigma_rad;
    sigma.edge_slope_rad[k] = std::hypot(sigma.edge_rad[k], kSurfaceRad);
    sigma.length_mm[k] = std::hypot(sigma.depth_mm / rise, depth * sigma.edge_rad[k] / (rise * rise));
    sigma.opening_rad[k] = std::hypot(face_sigma((k + 2) % 3), face_sigma(k));
    sigma.face_slope_rad[k] = std::hypot(face_sigma(k), kSurfaceRad);
    const double share = sigma.length_mm[k] / std::max(wedge->edge_lengths_mm[k], 1e-3);
    relative += share * share;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    sigma.face_angle_rad[k] = std::hypot(sigma.edge_rad[k], sigma.edge_rad[(k + 1) % 3]);
  }
  sigma.volume_mm3 = wedge->volume_mm3 * std::sqrt(relative);
  if (exits == ExitDefinition::kExtent) {
    sigma.forget_lengths();
  }
}

/// Whether the foot of p lies in the triangle of the three exits, seen along z (patch frame).
bool in_outline(const std::array<Eigen::Vector2d, 3>& corner, const Eigen::Vector2d& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d side = corner[(k + 1) % 3] - corner[k];
    const Eigen::Vector2d to = p - corner[k];
    if (side.x() * to.y() - side.y() * to.x() < 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

WedgeCandidate measure_wedge(const WedgePatch& patch, const WedgeFaces& faces, const InnerEdges& edges,
                             const HeightSurface& surface, std::span<const float> vertex_area_mm2,
                             ExitDefinition exits) {
  WedgeCandidate out;
  Wedge& wedge = out.wedge;
  const Eigen::Vector3d depth_point = patch.to_model(edges.depth_point);
  wedge.depth_point_mm = depth_point;
  wedge.surface_normal = patch.model_from_patch.col(2);
  wedge.depth_mm = -static_cast<double>(surface.height_mm(depth_point.cast<float>()));
  const double depth = std::max(wedge.depth_mm, 0.01);

  std::array<Eigen::Vector2d, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) {
    const InnerEdge& edge = edges.edge[k];
    const Eigen::Vector3d direction = patch.model_from_patch * edge.direction;
    const auto crossing = surface.crossing(depth_point.cast<float>(), direction.cast<float>(),
                                           static_cast<float>(kReachDepths * depth));
    const Eigen::Vector3d seen_last = depth_point + edge.extent_mm * direction;
    Eigen::Vector3d& at_surface = wedge.exit_points_surface_mm[k];
    at_surface = crossing ? Eigen::Vector3d(crossing->cast<double>()) : seen_last;
    wedge.exit_points_extent_mm[k] = edge.extent_mm > 0 ? seen_last : at_surface;
    wedge.exit_points_mm[k] = exits == ExitDefinition::kSurface ? at_surface : wedge.exit_points_extent_mm[k];
    wedge.outer_vertices_mm[k] = wedge.exit_points_mm[k];
    wedge.edge_lengths_mm[k] = (wedge.exit_points_mm[k] - depth_point).norm();
    wedge.edge_slopes_rad[k] = std::asin(std::clamp(edge.direction.z(), -1.0, 1.0));
    wedge.edge_bows_mm[k] = edge.bow_mm;
    corner[k] =
        (patch.model_from_patch.transpose() * (wedge.exit_points_surface_mm[k] - patch.origin)).head<2>();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const FacePlane& before = faces.plane[(k + 2) % 3];
    const FacePlane& plane = faces.plane[k];
    wedge.face_normals[k] = patch.model_from_patch * plane.normal;
    wedge.face_slopes_rad[k] = std::acos(std::clamp(plane.normal.z(), -1.0, 1.0));
    wedge.face_angles_rad[k] = angle_between(edges.edge[k].direction, edges.edge[(k + 1) % 3].direction);
    wedge.opening_angles_rad[k] = kPi - angle_between(before.normal, plane.normal);
  }
  const std::array<Eigen::Vector3d, 3>& exit = wedge.exit_points_mm;
  wedge.volume_mm3 =
      std::abs((exit[0] - depth_point).dot((exit[1] - depth_point).cross(exit[2] - depth_point))) / 6.0;
  note_sigmas(faces, edges, patch.spacing_mm, exits, &wedge);
  choose_directional(&wedge);

  std::array<double, 3> seen{};
  double inside = 0;
  double rim = 0;
  double level = 0;
  double weight = 0;
  double squares = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const double area = vertex_area_mm2[patch.vertex[i]];
    const Eigen::Vector3d p = patch.p[i].cast<double>();
    if (i >= patch.inner) {
      ++rim;
      level += std::abs(patch.height[i]) < kLevelDepths * depth ? 1 : 0;
      continue;
    }
    out.hollow_mm2 += area;
    const bool within = in_outline(corner, p.head<2>());
    inside += within ? area : 0.0;
    if (faces.face[i] >= 0 && patch.height[i] < 0) {
      const auto k = static_cast<std::size_t>(faces.face[i]);
      const double off = faces.plane[k].distance(p);
      squares += off * off;
      weight += patch.weight[i];
      seen[k] += within ? area : 0.0;
      out.vertices.push_back(patch.vertex[i]);
      out.faces.push_back(faces.face[i]);
    }
  }
  out.level_rim = rim > 0 ? level / rim : 0.0;
  const double count = std::max<double>(1.0, static_cast<double>(out.vertices.size()));
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = wedge.exit_points_surface_mm[k] - depth_point;
    const Eigen::Vector3d b = wedge.exit_points_surface_mm[(k + 1) % 3] - depth_point;
    out.coverage[k] = std::min(1.0, seen[k] / std::max(0.5 * a.cross(b).norm(), 1e-6));
  }
  out.explained = inside > 0 ? (seen[0] + seen[1] + seen[2]) / inside : 0.0;
  out.rms_mm = std::sqrt(squares / count);
  const Eigen::Vector2d ab = corner[1] - corner[0];
  const Eigen::Vector2d ac = corner[2] - corner[0];
  out.area_mm2 = 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  wedge.vertex_count = static_cast<int>(out.vertices.size());
  wedge.reliability = std::clamp(weight / count, 0.0, 1.0);
  wedge.intact = (out.coverage[0] + out.coverage[1] + out.coverage[2]) / 3.0;
  return out;
}

}  // namespace dubsar
