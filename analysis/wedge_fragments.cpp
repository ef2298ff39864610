// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_fragments.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// Share of a piece's vertices that lie on the whole.
constexpr double kPiece = 0.5;
constexpr double kParallel = 0.966;  // cosine of 15 degrees
/// Vertices looked at per pair.
constexpr std::size_t kSamples = 200;

/// Of a shaft, whose depth may be that of the whole tablet, the nearest surface: what lies near its planes is
/// not all its own.
double tolerance_mm(const WedgeCandidate& c) {
  return std::max({0.03, 2.5 * c.rms_mm, 0.08 * c.nearest_mm});
}

double reach_mm(const WedgeCandidate& c) {
  double reach = 0;
  for (const Eigen::Vector3d& exit : c.wedge.exit_points_surface_mm) {
    reach = std::max(reach, (exit - c.wedge.depth_point_mm).norm());
  }
  return reach;
}

/// Whether p lies on the whole's faces, within its outline or a little outside of it.
bool lies_on(const WedgeCandidate& whole, double tolerance, const Eigen::Vector3d& p) {
  const Wedge& w = whole.wedge;
  double above = 1e30;
  for (const Eigen::Vector3d& normal : w.face_normals) {
    above = std::min(above, normal.dot(p - w.depth_point_mm));
  }
  if (std::abs(above) > tolerance) {
    return false;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& a = w.exit_points_surface_mm[k];
    const Eigen::Vector3d& b = w.exit_points_surface_mm[(k + 1) % 3];
    const Eigen::Vector3d outward = (b - a).cross(w.surface_normal).normalized();
    if (outward.dot(p - a) > 2.0 * tolerance) {
      return false;
    }
  }
  return true;
}

double share_on(const WedgeCandidate& piece, const WedgeCandidate& whole,
                std::span<const Eigen::Vector3f> position) {
  const double tolerance = tolerance_mm(whole);
  const std::size_t step = 1 + piece.vertices.size() / kSamples;
  std::size_t on = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < piece.vertices.size(); i += step) {
    ++all;
    on += lies_on(whole, tolerance, position[piece.vertices[i]].cast<double>()) ? 1 : 0;
  }
  return all > 0 ? static_cast<double>(on) / static_cast<double>(all) : 0.0;
}

/// Whether the piece is the end of the whole's tail behind something that was pressed across it: its longest
/// edge goes on in the line of the whole's, no deeper than that line.
bool continues(const WedgeCandidate& piece, const WedgeCandidate& whole) {
  const Wedge& w = whole.wedge;
  const Wedge& p = piece.wedge;
  const auto edge = static_cast<std::size_t>(w.directional_edge);
  const Eigen::Vector3d tail = w.exit_points_surface_mm[edge] - w.depth_point_mm;
  const double length = tail.norm();
  const Eigen::Vector3d own =
      (p.exit_points_surface_mm[static_cast<std::size_t>(p.directional_edge)] - p.depth_point_mm)
          .normalized();
  const Eigen::Vector3d to = p.depth_point_mm - w.depth_point_mm;
  const double along = to.dot(tail) / length;
  if (along < 0.2 * length || along > 1.3 * length || own.dot(tail) < kParallel * length) {
    return false;
  }
  const Eigen::Vector3d off = to - along / length * tail;
  const double up = off.dot(w.surface_normal);
  const double aside = (off - up * w.surface_normal).norm();
  return aside < 0.3 * whole.nearest_mm && up > -0.3 * whole.nearest_mm;
}

}  // namespace

void reject_fragments(std::span<const Eigen::Vector3f> position, std::vector<WedgeCandidate>* candidates) {
  // By x, so that each is compared with what is near alone.
  std::vector<std::size_t> order;
  std::vector<double> reach(candidates->size(), 0.0);
  double widest = 0;
  for (std::size_t i = 0; i < candidates->size(); ++i) {
    if ((*candidates)[i].rejected.empty()) {
      order.push_back(i);
      reach[i] = reach_mm((*candidates)[i]);
      widest = std::max(widest, reach[i]);
    }
  }
  const auto x_of = [&](std::size_t i) { return (*candidates)[i].wedge.depth_point_mm.x(); };
  std::ranges::stable_sort(order, {}, x_of);
  std::vector<std::uint8_t> piece(candidates->size(), 0);
  parallel_for_each_index(
      order.size(),
      [&](std::size_t at) {
        const std::size_t i = order[at];
        const WedgeCandidate& c = (*candidates)[i];
        const auto from = std::ranges::lower_bound(order, x_of(i) - widest - reach[i], {}, x_of);
        for (auto it = from; it != order.end() && x_of(*it) <= x_of(i) + widest + reach[i]; ++it) {
          const std::size_t j = *it;
          const WedgeCandidate& other = (*candidates)[j];
          const double apart = (other.wedge.depth_point_mm - c.wedge.depth_point_mm).norm();
          if (j == i || apart > reach[j] + reach[i]) {
            continue;
          }
          if (continues(c, other)) {
            piece[i] = 1;
            return;
          }
          const double mine = share_on(c, other, position);
          if (mine < kPiece) {
            continue;
          }
          const double theirs = share_on(other, c, position);
          const bool mutual = theirs >= kPiece;
          const bool smaller =
              c.vertices.size() != other.vertices.size() ? c.vertices.size() < other.vertices.size() : i > j;
          if (mutual ? smaller : mine > theirs) {
            piece[i] = 1;
            return;
          }
        }
      },
      16);
  for (std::size_t i = 0; i < piece.size(); ++i) {
    if (piece[i] != 0) {
      (*candidates)[i].rejected = "part of another wedge";
    }
  }
}

}  // namespace dubsar
