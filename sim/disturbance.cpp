// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/disturbance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr float kSkinAlbedo = 0.5F;
constexpr int kRings = 48;

/// Adds an ellipsoid of a frame of its own, seen as part of the tablet.
void add_ellipsoid(const Eigen::Vector3d& middle_mm, const Eigen::Vector3d& radii_mm,
                   const RigidTransform& tablet_from_own, SimTablet& to) {
  const auto first = static_cast<std::uint32_t>(to.mesh.positions.size());
  constexpr int kAround = 2 * kRings;
  for (int ring = 0; ring <= kRings; ++ring) {
    const double polar = kPi * ring / kRings;
    for (int k = 0; k < kAround; ++k) {
      const double azimuth = 2 * kPi * k / kAround;
      const Eigen::Vector3d unit(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                 std::cos(polar));
      const Eigen::Vector3d p = middle_mm + radii_mm.cwiseProduct(unit);
      to.mesh.positions.push_back((tablet_from_own * p).cast<float>());
    }
  }
  for (int ring = 0; ring < kRings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const auto at = [&](int r, int a) {
        return first + static_cast<std::uint32_t>(r * kAround + a % kAround);
      };
      to.mesh.faces.push_back({at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)});
      to.mesh.faces.push_back({at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)});
    }
  }
}

/// The highest of the vertices near a line, which stands on the tablet along one of its axes.
double highest(const SimTablet& tablet, const Eigen::Vector3d& foot_mm, const Eigen::Vector3d& up) {
  constexpr double kNearMm = 3.0;
  double out = 0;
  for (const Eigen::Vector3f& vertex : tablet.mesh.positions) {
    const Eigen::Vector3d p = vertex.cast<double>() - foot_mm;
    const double height = p.dot(up);
    if ((p - height * up).norm() < kNearMm) {
      out = std::max(out, height);
    }
  }
  return out;
}

void add_grip(const SimTablet& tablet, const RigidTransform& tablet_from_scanner, int turn, SimTablet& to) {
  constexpr double kGoldenAngle = 2.399963;
  constexpr double kOverTheEdgeMm = 7.0;
  constexpr double kPressedMm = 4.0;  ///< the middle of a finger is nearer to the face by that than its skin
  const Eigen::Vector3d radii_mm(16, 8, 6);
  const double angle = kGoldenAngle * turn;
  RigidTransform tablet_from_hand;
  tablet_from_hand.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d out = tablet_from_hand.rotation.col(0);
  const Eigen::Vector3d along = tablet_from_hand.rotation.col(1);
  const double to_scanner = tablet_from_scanner.rotation(2, 2) < 0 ? -1.0 : 1.0;
  const auto add_finger = [&](double across_mm, double side) {
    const double edge_mm = highest(tablet, across_mm * along, out);
    const Eigen::Vector3d tip = across_mm * along + (edge_mm - kOverTheEdgeMm) * out;
    const double face_mm = highest(tablet, tip, {0, 0, side});
    add_ellipsoid(
        {edge_mm - kOverTheEdgeMm + radii_mm.x(), across_mm, side * (face_mm + radii_mm.z() - kPressedMm)},
        radii_mm, tablet_from_hand, to);
  };
  add_finger(0.0, to_scanner);
  add_finger(-9.0, -to_scanner);
  add_finger(9.0, -to_scanner);
}

}  // namespace

SimTablet disturbed(const SimTablet& tablet, const RigidTransform& tablet_from_scanner, Disturbance what,
                    int turn) {
  SimTablet out;
  if (what == Disturbance::kGone) {
    const Eigen::Vector3f far = (tablet_from_scanner * Eigen::Vector3d(0, 0, -1e5)).cast<float>();
    out.mesh.positions = {far, far + Eigen::Vector3f(1, 0, 0), far + Eigen::Vector3f(0, 1, 0)};
    out.mesh.faces = {{0, 1, 2}};
  } else {
    out.mesh.positions = tablet.mesh.positions;
    out.mesh.faces = tablet.mesh.faces;
    out.albedo = tablet.albedo;
    const RigidTransform scanner_from_tablet = tablet_from_scanner.inverse();
    double top = -1e9;
    for (const Eigen::Vector3f& p : tablet.mesh.positions) {
      top = std::max(top, (scanner_from_tablet * p.cast<double>()).z());
    }
    if (what == Disturbance::kHand) {
      // From the right: fingers up to the middle, the palm beside them.
      for (const double y : {-27.0, -9.0, 9.0, 27.0}) {
        add_ellipsoid({34, y, top + 4}, {38, 8, 7}, tablet_from_scanner, out);
      }
      add_ellipsoid({95, 0, top + 6}, {45, 42, 13}, tablet_from_scanner, out);
    } else if (what == Disturbance::kGrip) {
      add_grip(tablet, tablet_from_scanner, turn, out);
    } else {
      add_ellipsoid({10, 0, top + 2}, {90, 60, 14}, tablet_from_scanner, out);
      for (const double y : {-33.0, -11.0, 11.0, 33.0}) {
        add_ellipsoid({-60, y, top + 3}, {50, 9, 8}, tablet_from_scanner, out);
      }
    }
  }
  const std::size_t vertices = out.mesh.positions.size();
  out.albedo.resize(vertices, kSkinAlbedo);
  out.kinds.assign(vertices, SurfaceKind::kBody);
  out.wedge_of.assign(vertices, -1);
  out.mesh.normals = vertex_normals(out.mesh);
  return out;
}

}  // namespace dubsar::sim
