// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/mesh_faults.h"

#include <utility>

#include "core/random.h"

namespace dubsar::bench {

void add_faults(std::uint64_t seed, Mesh* mesh) {
  Random random(seed_for(seed, 31));
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(mesh->faces.size());
  for (const auto& face : mesh->faces) {
    const double draw = random.uniform();
    if (draw < 0.01) {
      continue;
    }
    faces.push_back(face);
    if (draw < 0.015) {
      faces.push_back(face);
    } else if (draw < 0.02) {
      std::swap(faces.back()[0], faces.back()[1]);
    }
  }
  mesh->faces = std::move(faces);
  const std::size_t own = mesh->positions.size();
  const std::size_t scraps = mesh->faces.size() / 1000;
  for (std::size_t i = 0; i < scraps; ++i) {
    const Eigen::Vector3f& at = mesh->positions[random.below(own)];
    const auto shift = [&](double size) { return Eigen::Vector3f((size * random.normal3()).cast<float>()); };
    const auto first = static_cast<std::uint32_t>(mesh->positions.size());
    const Eigen::Vector3f middle = at + shift(0.4);
    for (int corner = 0; corner < 4; ++corner) {
      mesh->positions.push_back(middle + shift(0.1));
    }
    mesh->faces.push_back({first, first + 1, first + 2});
    mesh->faces.push_back({first + 1, first + 3, first + 2});
  }
  // What was known of each vertex does not hold for the new ones.
  mesh->normals.clear();
  mesh->reliability.clear();
  mesh->scans.clear();
  mesh->flags.clear();
  mesh->colours.clear();
}

}  // namespace dubsar::bench
