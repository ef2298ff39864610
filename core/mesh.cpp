// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh.h"

#include "core/parallel.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace dubsar {

std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.positions.size(), Eigen::Vector3f::Zero());
  parallel_ranges(normals.size(), [&](std::size_t begin, std::size_t end) {
    const auto is_here = [&](std::uint32_t v) { return v >= begin && v < end; };
    for (const auto& f : mesh.faces) {
      if (!is_here(f[0]) && !is_here(f[1]) && !is_here(f[2])) {
        continue;
      }
      if (std::max({f[0], f[1], f[2]}) >= normals.size()) {
        continue;  // a broken one, that names a vertex which is not there
      }
      const Eigen::Vector3f n =
          (mesh.positions[f[1]] - mesh.positions[f[0]]).cross(mesh.positions[f[2]] - mesh.positions[f[0]]);
      for (const std::uint32_t v : f) {
        if (is_here(v)) {
          normals[v] += n;
        }
      }
    }
    for (std::size_t v = begin; v < end; ++v) {
      const float length = normals[v].norm();
      if (length > 0) {
        normals[v] /= length;
      }
    }
  });
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
