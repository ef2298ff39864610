// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/pebble.h"

#include <algorithm>
#include <cmath>

#include "tests/support/raster_mesh.h"

namespace dubsar::bench {

namespace {

const Eigen::Vector3f kHalf{55, 40, 15};  // mm

/// Where the ray through p, on the cube of half side 1, leaves the body |x|⁴ + |y|⁴ + |z|⁴ = 1, with dents
/// of 0.3 mm, 3 to 5 mm apart.
Eigen::Vector3f on_body(const Eigen::Vector3f& p) {
  const float norm = std::pow(p.array().abs().pow(4.0F).sum(), 0.25F);
  const Eigen::Vector3f at = p.cwiseProduct(kHalf) / norm;
  const float relief = std::sin(2.1F * at.x() + std::sin(1.3F * at.z())) * std::sin(1.7F * at.y()) *
                       std::sin(1.9F * at.z() + 0.5F * at.x());
  return at - 0.3F * std::max(0.0F, relief) * at.normalized();
}

}  // namespace

Mesh pebble(double million_faces) {
  const auto cells = static_cast<std::uint32_t>(std::max(1.0, std::sqrt(million_faces * 1e6 / 12)));
  Mesh mesh;
  const auto side = static_cast<std::size_t>(cells + 1) * (cells + 1);
  mesh.positions.reserve(6 * side);
  mesh.faces.reserve(std::size_t{12} * cells * cells);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t v = 0; v <= cells; ++v) {
        for (std::uint32_t u = 0; u <= cells; ++u) {
          Eigen::Vector3f p;
          p[axis] = sign;
          p[(axis + 1) % 3] = sign * (2.0F * static_cast<float>(u) / static_cast<float>(cells) - 1.0F);
          p[(axis + 2) % 3] = 2.0F * static_cast<float>(v) / static_cast<float>(cells) - 1.0F;
          mesh.positions.push_back(on_body(p));
        }
      }
      test::add_raster_faces(mesh, first, cells);
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

}  // namespace dubsar::bench
