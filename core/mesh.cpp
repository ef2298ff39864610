// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh.h"

#include <Eigen/Geometry>

namespace dubsar {

std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f n =
        (mesh.positions[f[1]] - mesh.positions[f[0]]).cross(mesh.positions[f[2]] - mesh.positions[f[0]]);
    for (const std::uint32_t v : f) {
      normals[v] += n;
    }
  }
  for (Eigen::Vector3f& n : normals) {
    const float length = n.norm();
    if (length > 0) {
      n /= length;
    }
  }
  return normals;
}

double surface_area_mm2(const Mesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.positions[f[0]].cast<double>();
    area +=
        0.5 * (mesh.positions[f[1]].cast<double>() - a).cross(mesh.positions[f[2]].cast<double>() - a).norm();
  }
  return area;
}

}  // namespace dubsar
