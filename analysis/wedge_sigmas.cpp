// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_sigmas.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

/// What the fits say of themselves takes every few vertices for independent. On scanned and stitched meshes
/// neighbours err together: so many times as large is what the errors on simulated tablets are
/// (dubsar-wedges prints them against these).
constexpr double kPointTogether = 1.7;
constexpr double kEdgeTogether = 1.8;
constexpr double kPlaneTogether = 1.0;
/// Where scans lay few samples across an impression, stitching rounds what lies between them: beyond so many
/// spacings to a depth the sigmas grow, as the errors do. Fitted to simulated tablets scanned at µ 0.05,
/// 0.075 and 0.1 mm, with true poses and with ones that are 20 µm off; of edges and depth points to sessions
/// at µ 0.1 mm (noise 5 and 20 µm, seeds 1 and 3).
constexpr double kFineSpacings = 0.15;
constexpr double kCoarseGrowth = 4.0;
constexpr double kCoarseFaceGrowth = 1.5;
/// A face's direction is not known better: its clay is not quite even.
constexpr double kFaceRad = 0.006;
/// Of the free surface above an impression, which nobody has seen: where it lies, at least and as a share of
/// the depth (its dam grows with a wedge, and so does what bridging it leaves open), and which way it looks.
constexpr double kSurfaceMm = 0.02;
constexpr double kSurfaceShare = 0.05;
constexpr double kSurfaceRad = 0.013;

/// What no fit says of itself: what is left of a face that another wedge was pressed across may be that
/// wedge's clay, or moved by it. It shows in how much of the face is missing (its square), in how far the
/// line of contact points lies from where the two planes meet, and where nothing of that line is left. Fitted
/// as the 95 % quantile of the errors of clean and scanned simulated tablets, µ 0.05 to 0.1 mm, from
/// undamaged to badly damaged (2850 wedges, those of which less is left with more weight); checked on 1500
/// others.
constexpr double kMissingRad = 0.32;
constexpr double kFaceOffPlanes = 0.9;
constexpr double kFaceNoLineRad = 0.13;
constexpr double kEdgeOffPlanes = 0.9;
constexpr double kEdgeNoLineRad = 0.24;
/// Lines farther off the planes say no more.
constexpr double kMostOffRad = 0.5;

/// A face whose clay begins farther from the depth point than that of another, by so many depths and
/// spacings, is in three cases of ten that of another wedge beside this one, and then some 30 degrees off.
constexpr double kDetachedDepths = 0.35;
constexpr double kDetachedSpacings = 1.0;
constexpr double kDetachedRad = 0.3;

/// Where all edges are worn the clay of every face turns as a hollow does, and the least of the three turns
/// says how far: openings are wider than those of the sharp wedge, and depths and depth points too high, all
/// the same way. So many times that turn is in the sigmas, of lengths times the depth; an edge between two
/// faces that are worn alike, as the directional one, is moved less. Fitted to ideal wedges rounded by a
/// Gaussian of 0 to 0.1 mm (docs/scholars/measurements.md, "Worn wedges"); on tablets that are not worn the
/// least turn is below 0.5 degrees for nine in ten.
constexpr double kWornFace = 2.0;
constexpr double kWornEdge = 1.5;
constexpr double kWornDirectional = 0.3;
constexpr double kWornDepths = 2.5;
/// More than this says no more.
constexpr double kMostWornRad = 0.25;

/// Beside a rim the surface is cut short and leans over, and its slope and its height are known so much
/// worse. What curved sides of tablets show without one is left out. Fitted to boxes with rims of 0.4 and 1
/// mm, wedges 0.7 to 1.5 mm from them (docs/scholars/measurements.md, "Beside a rim").
constexpr double kRimRad = 0.02;
constexpr double kRimShare = 1.0;
constexpr double kRimMm = 0.5;

/// Of a face or an edge, by how far the line lies off the planes.
double disagreement_rad(const InnerEdge& edge, double share, double no_line_rad) {
  return std::isnan(edge.off_planes_rad) ? no_line_rad : share * std::min(edge.off_planes_rad, kMostOffRad);
}

double missing_rad(double coverage) {
  const double missing = std::clamp(1.0 - coverage, 0.0, 1.0);
  return kMissingRad * missing * missing;
}

}  // namespace

void note_sigmas(const WedgeFaces& faces, const InnerEdges& edges, const FacesSeen& seen, double spacing_mm,
                 ExitDefinition exits, Wedge* wedge) {
  const std::array<double, 3>& coverage = seen.coverage;
  WedgeSigma& sigma = wedge->sigma;
  const double depth = std::max(wedge->depth_mm, 0.01);
  const double beyond = std::max(0.0, spacing_mm / depth - kFineSpacings);
  const double coarse = 1.0 + kCoarseGrowth * beyond;
  const double nearest_mm = std::ranges::min(seen.gap_mm);
  const double worn = std::clamp(std::ranges::min(seen.turn_rad), 0.0, kMostWornRad);
  const double rim = std::max(0.0, seen.rim_rad - kRimRad);
  const double surface_rad = std::hypot(kSurfaceRad, kRimShare * rim);
  std::array<double, 3> face{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double fit = (1.0 + kCoarseFaceGrowth * beyond) * kPlaneTogether * faces.plane[k].sigma_rad;
    const double sides =
        std::hypot(disagreement_rad(edges.edge[k], kFaceOffPlanes, kFaceNoLineRad),
                   disagreement_rad(edges.edge[(k + 1) % 3], kFaceOffPlanes, kFaceNoLineRad));
    const bool detached =
        seen.gap_mm[k] > nearest_mm + kDetachedDepths * depth + kDetachedSpacings * spacing_mm;
    face[k] = std::hypot(std::hypot(fit, kFaceRad), std::hypot(sides, detached ? kDetachedRad : 0.0),
                         std::hypot(missing_rad(coverage[k]), kWornFace * worn));
  }
  const double fitted_mm = coarse * kPointTogether * edges.depth_point_sigma_mm;
  const double worn_mm = kWornDepths * worn * depth;
  sigma.depth_point_mm = std::hypot(fitted_mm, worn_mm);
  sigma.depth_mm =
      std::hypot(fitted_mm / std::sqrt(3.0), std::max(kSurfaceMm, kSurfaceShare * wedge->depth_mm),
                 std::hypot(worn_mm, kRimMm * rim));
  double relative = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const InnerEdge& edge = edges.edge[k];
    const std::size_t before = (k + 2) % 3;
    const double rise = std::max(edge.direction.z(), 0.03);
    const bool directional = static_cast<int>(k) == wedge->directional_edge;
    sigma.edge_rad[k] = std::hypot(coarse * kEdgeTogether * edge.sigma_rad,
                                   disagreement_rad(edge, kEdgeOffPlanes, kEdgeNoLineRad),
                                   std::hypot(missing_rad(coverage[before]), missing_rad(coverage[k]),
                                              (directional ? kWornDirectional : kWornEdge) * worn));
    sigma.edge_slope_rad[k] = std::hypot(sigma.edge_rad[k], surface_rad);
    sigma.length_mm[k] = std::hypot(sigma.depth_mm / rise, depth * sigma.edge_rad[k] / (rise * rise));
    sigma.opening_rad[k] = std::hypot(face[before], face[k]);
    sigma.face_slope_rad[k] = std::hypot(face[k], surface_rad);
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

}  // namespace dubsar
