// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/tablet_frame.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

namespace dubsar {

namespace {

// Of the second moment, as shares of its trace: a cube has three thirds, a thin plate 1, 0, 0. A tablet of
// 50 × 40 × 20 mm has 0.53.
constexpr double kSlabLead = 0.08;       ///< by which the largest must exceed the second
constexpr double kStraightEdges = 0.15;  ///< of the fourfold moment: 1 for a box, 0 for a disc
constexpr double kEdgeNormalZ = 0.6;     ///< steeper than this belongs to the edges

bool is_usable(const SurfaceElement& e) {
  return e.position_mm.allFinite() && e.area_normal.allFinite() && e.area_normal.squaredNorm() > 0;
}

/// The axis across the slab, or nothing.
Eigen::Vector3d slab_axis(std::span<const SurfaceElement> surface) {
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const SurfaceElement& e : surface) {
    if (is_usable(e)) {
      const Eigen::Vector3d n = e.area_normal.cast<double>();
      moment += n * n.transpose() / n.norm();
    }
  }
  const double trace = moment.trace();
  if (!(trace > 0) || !std::isfinite(trace)) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment / trace);
  if (solver.info() != Eigen::Success || solver.eigenvalues()[2] - solver.eigenvalues()[1] < kSlabLead) {
    return Eigen::Vector3d::Zero();
  }
  return solver.eigenvectors().col(2);
}

/// Angle of one pair of edges about z, from the plane's axis u, within a quarter turn; nothing when the
/// outline is too round.
double edge_angle(std::span<const SurfaceElement> surface, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                  const Eigen::Vector3d& z) {
  std::complex<double> fourfold = 0;
  double weight = 0;
  for (const SurfaceElement& e : surface) {
    if (!is_usable(e)) {
      continue;
    }
    const Eigen::Vector3d n = e.area_normal.cast<double>();
    const double area = n.norm();
    if (std::abs(n.dot(z)) < kEdgeNormalZ * area) {
      const std::complex<double> across(n.dot(u) / area, n.dot(v) / area);
      const double r = std::abs(across);
      fourfold += area * r * std::pow(across / r, 4);
      weight += area * r;
    }
  }
  return weight > 0 && std::abs(fourfold) > kStraightEdges * weight
             ? std::arg(fourfold) / 4
             : std::numeric_limits<double>::quiet_NaN();
}

RigidTransform centred(std::span<const SurfaceElement> surface, const Eigen::Matrix3d& tablet_from_model) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const SurfaceElement& e : surface) {
    if (is_usable(e)) {
      const Eigen::Vector3d p = tablet_from_model * e.position_mm.cast<double>();
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  RigidTransform frame;
  frame.rotation = tablet_from_model;
  if (low.allFinite() && high.allFinite()) {
    frame.translation_mm = -0.5 * (low + high);
  }
  return frame;
}

}  // namespace

RigidTransform tablet_frame(std::span<const SurfaceElement> surface) {
  Eigen::Vector3d z = slab_axis(surface);
  if (z.isZero()) {
    return centred(surface, Eigen::Matrix3d::Identity());
  }
  if (z.z() < 0) {
    z = -z;
  }
  // The model's x, or its y where x runs across the slab, as far as it lies in the slab.
  const bool x_lies_across = std::abs(z.x()) > 0.9;
  const Eigen::Vector3d hint = x_lies_across ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  Eigen::Vector3d u = (hint - z * z.dot(hint)).normalized();
  Eigen::Vector3d v = z.cross(u);
  const double angle = edge_angle(surface, u, v, z);
  if (std::isfinite(angle)) {
    const Eigen::Vector3d turned = std::cos(angle) * u + std::sin(angle) * v;
    v = z.cross(turned);
    u = turned;
  }
  // Of the four quarter turns, the one whose axes agree best with the model's.
  Eigen::Matrix3d best;
  double best_agreement = -std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double agreement = u.x() + v.y();
    if (agreement > best_agreement + 1e-9) {
      best_agreement = agreement;
      best.row(0) = u;
      best.row(1) = v;
      best.row(2) = z;
    }
    const Eigen::Vector3d next = v;
    v = -u;
    u = next;
  }
  return centred(surface, best);
}

RigidTransform tablet_frame(const Mesh& mesh) {
  std::vector<SurfaceElement> surface;
  surface.reserve(mesh.faces.size());
  for (const auto& [a, b, c] : mesh.faces) {
    if (std::max({a, b, c}) < mesh.positions.size()) {
      const Eigen::Vector3f& p = mesh.positions[a];
      const Eigen::Vector3f& q = mesh.positions[b];
      const Eigen::Vector3f& r = mesh.positions[c];
      surface.push_back({(p + q + r) / 3.0F, (q - p).cross(r - p) * 0.5F});
    }
  }
  return tablet_frame(surface);
}

}  // namespace dubsar
