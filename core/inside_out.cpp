// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/inside_out.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace dubsar {

namespace {

/// Share of the whole area-times-distance that must point inwards before the orientation of an open surface
/// is doubted, and of a closed one.
constexpr double kClearlyInward = -0.5;
constexpr double kInward = -0.01;
/// What a surface's normals sum up to at most, as a share of its area, where it is as good as closed.
constexpr double kClosed = 0.03;

template <class Visit>
void for_each_whole_face(const Mesh& mesh, const Visit& visit) {
  const std::size_t count = mesh.positions.size();
  for (const auto& f : mesh.faces) {
    if (std::max({f[0], f[1], f[2]}) < count && mesh.positions[f[0]].allFinite() &&
        mesh.positions[f[1]].allFinite() && mesh.positions[f[2]].allFinite()) {
      visit(mesh.positions[f[0]].cast<double>(), mesh.positions[f[1]].cast<double>(),
            mesh.positions[f[2]].cast<double>());
    }
  }
}

Facing facing_of(const Mesh& mesh) {
  using P = Eigen::Vector3d;
  Facing out;
  P centre = P::Zero();
  for_each_whole_face(mesh, [&](const P& a, const P& b, const P& c) {
    const P facing = 0.5 * (b - a).cross(c - a);
    out.normals_mm2 += facing;
    out.area_mm2 += facing.norm();
    centre += facing.norm() / 3 * (a + b + c);
  });
  if (out.area_mm2 > 0) {
    centre /= out.area_mm2;
  }
  for_each_whole_face(mesh, [&](const P& a, const P& b, const P& c) {
    const P facing = 0.5 * (b - a).cross(c - a);
    const P away = (a + b + c) / 3 - centre;
    out.outward_mm3 += facing.dot(away);
    out.spread_mm3 += facing.norm() * away.norm();
  });
  return out;
}

}  // namespace

bool Facing::is_inward() const {
  const bool closed = normals_mm2.norm() < kClosed * area_mm2;
  return outward_mm3 < (closed ? kInward : kClearlyInward) * spread_mm3;
}

double signed_volume_mm3(const Mesh& mesh) {
  return facing_of(mesh).outward_mm3 / 3;
}

bool is_inside_out(const Mesh& mesh) {
  return facing_of(mesh).is_inward();
}

void turn_over(Mesh* mesh) {
  for (auto& face : mesh->faces) {
    std::swap(face[1], face[2]);
  }
  for (Eigen::Vector3f& normal : mesh->normals) {
    normal = -normal;
  }
}

}  // namespace dubsar
