// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "analysis/roundness.h"
#include "analysis/wedge_sigmas.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// An inner edge that has not met the surface after so many depths does not meet it.
constexpr double kReachDepths = 30.0;

/// A rim is at the free surface within so many depths.
constexpr double kLevelDepths = 0.2;

/// Of a face that has no clay.
constexpr double kNoneMm = 1e3;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The nearest surface is that above the wedge while it looks less far from the wedge's own up than this
/// (cosine): the floor of a deep hole may be nearer to another side of the tablet.
constexpr double kSameSide = 0.5;

/// How far p lies below the surface that looks along `up`: the nearest of that side, or else as far as it is
/// along `up`; 0 where there is none.
double depth_below(const HeightSurface& surface, const Eigen::Vector3d& p, const Eigen::Vector3d& up) {
  const double nearest_mm = -static_cast<double>(surface.height_mm(p.cast<float>()));
  const Eigen::Vector3f looks = surface.normal(p.cast<float>());
  if (looks.cast<double>().dot(up) > kSameSide) {
    return nearest_mm;
  }
  constexpr int kMostCrossings = 3;  // into the clay and out of it, where p has come out beyond the tablet
  constexpr float kReachMm = 100;
  constexpr float kOnMm = 1e-3F;
  Eigen::Vector3f from = p.cast<float>();
  for (int i = 0; i < kMostCrossings; ++i) {
    const auto at = surface.crossing(from, up.cast<float>(), kReachMm);
    if (!at) {
      break;
    }
    if (surface.normal(*at).cast<double>().dot(up) > 0) {
      return up.dot(at->cast<double>() - p);
    }
    from = *at + kOnMm * up.cast<float>();
  }
  return std::max(nearest_mm, 0.0);
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

/// A rim of the tablet shows within so many cells of the free surface, which is smooth over a few of them.
constexpr double kRimCells = 2.0;

/// How far the free surface leans over at the foot of p because a rim is near, radians: by how much it has
/// turned there from where it bends less, on the one side of the foot, as far as it bends more on the other.
/// None on a plane, a ball or a roll, which bend alike.
double rim_rad(const HeightSurface& surface, const Eigen::Vector3d& p) {
  const auto foot = surface.closest(p.cast<float>());
  const Eigen::Vector3f up = foot ? surface.normal(*foot) : Eigen::Vector3f::Zero();
  if (up.isZero()) {
    return 0;
  }
  const float reach = static_cast<float>(kRimCells) * surface.cell_mm();
  const Eigen::Vector3f across = up.unitOrthogonal();
  const Eigen::Vector3f along = up.cross(across);
  constexpr int kWays = 4;
  double most = 0;
  for (int i = 0; i < kWays; ++i) {
    const auto turn = static_cast<float>(kPi) * static_cast<float>(i) / kWays;
    const Eigen::Vector3f way = std::cos(turn) * across + std::sin(turn) * along;
    const double ahead = surface.normal(*foot + reach * way).dot(way);
    const double behind = -surface.normal(*foot - reach * way).dot(way);
    const double less = std::min(ahead, behind);
    const double more = std::max(ahead, behind);
    if (less > 0) {
      most = std::max(most, std::asin(std::min(less, 1.0)) * (more - less) / (more + less));
    }
  }
  return most;
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
  wedge.depth_mm = depth_below(surface, depth_point, wedge.surface_normal);
  out.nearest_mm = -static_cast<double>(surface.height_mm(depth_point.cast<float>()));
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
  choose_directional(&wedge);

  std::array<double, 3> seen{};
  std::array<double, 3> gap_mm;
  gap_mm.fill(kNoneMm);
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
      gap_mm[k] = std::min(gap_mm[k], (p - edges.depth_point).norm());
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
  wedge.faces_intact = out.coverage;
  wedge.intact = (out.coverage[0] + out.coverage[1] + out.coverage[2]) / 3.0;
  const Roundness round = roundness_of(patch, faces);
  wedge.roundness = round.share;
  note_sigmas(faces, edges, {out.coverage, gap_mm, round.turn_rad, rim_rad(surface, depth_point)},
              patch.spacing_mm, exits, &wedge);
  return out;
}

}  // namespace dubsar
