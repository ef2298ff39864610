// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/inside_out.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace dubsar {

namespace {

/// Sums over the faces that are none of them broken.
struct Enclosure {
  double volume_mm3 = 0;
  double area_mm2 = 0;
  Eigen::Vector3d facing_mm2{0, 0, 0};  ///< the faces' areas as vectors: zero for what is closed
};

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

Enclosure enclosure_of(const Mesh& mesh) {
  using P = Eigen::Vector3d;
  P middle = P::Zero();
  double faces = 0;
  for_each_whole_face(mesh, [&](const P& a, const P& b, const P& c) {
    middle += (a + b + c) / 3;
    faces += 1;
  });
  middle /= std::max(faces, 1.0);
  Enclosure out;
  for_each_whole_face(mesh, [&](const P& a, const P& b, const P& c) {
    const P facing = 0.5 * (b - a).cross(c - a);
    out.facing_mm2 += facing;
    out.area_mm2 += facing.norm();
    out.volume_mm3 += facing.dot(a - middle) / 3;
  });
  return out;
}

}  // namespace

double signed_volume_mm3(const Mesh& mesh) {
  return enclosure_of(mesh).volume_mm3;
}

bool is_inside_out(const Mesh& mesh) {
  constexpr double kMostOpen = 0.1;  // of the area: a hole of a tenth leaves the volume its sign
  const Enclosure all = enclosure_of(mesh);
  return all.volume_mm3 < 0 && all.facing_mm2.norm() < kMostOpen * all.area_mm2;
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
