// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/face_cut.h"

#include <Eigen/Geometry>
#include <cmath>

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Corners = std::array<Vector3d, 3>;

/// The sign of the volume of the tetrahedron abcd; 0 where rounding could have made it: of corners that lie
/// in one plane, as samples do whose depths come in steps, it would be any. Differences of floats are exact
/// here but for their last bits; the bound is that of Shewchuk, "Adaptive precision floating-point arithmetic
/// and fast robust geometric predicates", 1997, for the determinant.
int side_of(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  constexpr double kRounding = 8e-16;
  const Vector3d u = b - a;
  const Vector3d v = c - a;
  const Vector3d w = d - a;
  const double volume = u.cross(v).dot(w);
  const Vector3d size = u.cwiseAbs();
  const Vector3d other = v.cwiseAbs();
  const double most = (size.y() * other.z() + size.z() * other.y()) * std::abs(w.x()) +
                      (size.z() * other.x() + size.x() * other.z()) * std::abs(w.y()) +
                      (size.x() * other.y() + size.y() * other.x()) * std::abs(w.z());
  return std::abs(volume) <= kRounding * most ? 0 : volume > 0 ? 1 : -1;
}

/// Whether the segment pq passes through the inside of the triangle.
bool passes_through(const Vector3d& p, const Vector3d& q, const Corners& t) {
  if (side_of(t[0], t[1], t[2], p) * side_of(t[0], t[1], t[2], q) >= 0) {
    return false;
  }
  const int turn = side_of(p, q, t[0], t[1]);
  return turn != 0 && side_of(p, q, t[1], t[2]) == turn && side_of(p, q, t[2], t[0]) == turn;
}

using Positions = std::span<const Vector3f>;
using Face = std::array<std::uint32_t, 3>;

Corners corners_of(Positions positions, const Face& f) {
  return {positions[f[0]].cast<double>(), positions[f[1]].cast<double>(), positions[f[2]].cast<double>()};
}

bool has(const Face& f, std::uint32_t v) {
  return v == f[0] || v == f[1] || v == f[2];
}

/// Whether the corners of `other` lie on both sides of the plane of f; those that they share lie in it.
bool straddles(Positions positions, const Face& f, const FacePlane& plane, const Face& other) {
  bool above = false;
  bool below = false;
  for (const std::uint32_t v : other) {
    if (!has(f, v)) {
      const double side = plane.normal.dot(positions[v].cast<double>()) - plane.offset;
      above = above || side > 0;
      below = below || side < 0;
    }
  }
  return above && below;
}

bool edges_cut(const Face& f, const Corners& c, const Face& other, const Corners& t) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (!has(other, f[k]) && !has(other, f[next]) && passes_through(c[k], c[next], t)) {
      return true;
    }
  }
  return false;
}

/// Of two faces that share one corner: whether one of the walls on a's edges from there, upright on it, has a
/// on one side and b on the other. So it is with most, as faces lie around a vertex side by side.
bool are_apart(Positions positions, const Face& fa, const FacePlane& pa, const Face& fb) {
  const auto place = [&](std::uint32_t v) { return positions[v].cast<double>(); };
  const std::size_t at = has(fb, fa[0]) ? 0 : has(fb, fa[1]) ? 1 : 2;
  const Vector3d corner = place(fa[at]);
  const Vector3d next_wall = pa.normal.cross(place(fa[(at + 1) % 3]) - corner);  // towards the face
  const Vector3d last_wall = (place(fa[(at + 2) % 3]) - corner).cross(pa.normal);
  bool beyond_next = true;
  bool beyond_last = true;
  for (const std::uint32_t v : fb) {
    if (v != fa[at]) {
      const Vector3d d = place(v) - corner;
      beyond_next = beyond_next && next_wall.dot(d) < 0;
      beyond_last = beyond_last && last_wall.dot(d) < 0;
    }
  }
  return beyond_next || beyond_last;
}

}  // namespace

FacePlane::FacePlane(Positions positions, const Face& f) {
  const Corners c = corners_of(positions, f);
  normal = (c[1] - c[0]).cross(c[2] - c[0]);
  offset = normal.dot(c[0]);
}

bool faces_cut(Positions positions, const Face& fa, const FacePlane& pa, const Face& fb) {
  const int shared = (has(fb, fa[0]) ? 1 : 0) + (has(fb, fa[1]) ? 1 : 0) + (has(fb, fa[2]) ? 1 : 0);
  if (shared > 1) {
    return false;
  }
  const bool a_cuts = straddles(positions, fa, pa, fb);
  if (shared == 0 ? !a_cuts : are_apart(positions, fa, pa, fb)) {
    return false;
  }
  // Of two faces that share a corner either may be the one whose far edge passes through the other.
  const bool b_cuts = straddles(positions, fb, FacePlane(positions, fb), fa);
  if (shared == 0 ? !b_cuts : !a_cuts && !b_cuts) {
    return false;
  }
  const Corners ca = corners_of(positions, fa);
  const Corners cb = corners_of(positions, fb);
  return edges_cut(fa, ca, fb, cb) || edges_cut(fb, cb, fa, ca);
}

}  // namespace dubsar
