// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_projection.h"

#include <Eigen/Geometry>
#include <cmath>

namespace dubsar::bench {

using Eigen::Vector3f;

LinkProjector::LinkProjector(const LinkMesh& on)
    : mesh_(&on), first_(on.positions.size() + 1), faces_(3 * on.faces.size()) {
  for (const auto& f : on.faces) {
    for (const std::uint32_t v : f) {
      ++first_[v + 1];
    }
  }
  for (std::size_t v = 1; v < first_.size(); ++v) {
    first_[v] += first_[v - 1];
  }
  std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
  for (std::size_t f = 0; f < on.faces.size(); ++f) {
    for (const std::uint32_t v : on.faces[f]) {
      faces_[at[v]++] = static_cast<std::uint32_t>(f);
    }
  }
}

template <class Visit>
void LinkProjector::for_each_face_near(std::uint32_t vertex, const Visit& visit) const {
  // Those of a neighbour come up more than once; that costs less than to keep book of them.
  for (std::uint32_t k = first_[vertex]; k < first_[vertex + 1]; ++k) {
    for (const std::uint32_t w : mesh_->faces[faces_[k]]) {
      for (std::uint32_t j = first_[w]; w != vertex && j < first_[w + 1]; ++j) {
        visit(mesh_->faces[faces_[j]]);
      }
    }
  }
}

std::optional<Vector3f> LinkProjector::along(const Vector3f& p, const Vector3f& line, std::uint32_t near,
                                             float most_mm) const {
  constexpr float kSlack = -1e-4F;  // so that a line does not slip between two triangles
  float best = most_mm;
  std::optional<Vector3f> out;
  for_each_face_near(near, [&](const std::array<std::uint32_t, 3>& f) {
    // Moeller and Trumbore 1997.
    const Vector3f a = mesh_->positions[f[0]];
    const Vector3f ab = mesh_->positions[f[1]] - a, ac = mesh_->positions[f[2]] - a;
    const Vector3f h = line.cross(ac);
    const float det = ab.dot(h);
    if (!(det < 0)) {  // turned away, or along the line
      return;
    }
    const float u = (p - a).dot(h) / det;
    const Vector3f q = (p - a).cross(ab);
    const float v = line.dot(q) / det;
    const float t = ac.dot(q) / det;
    if (u >= kSlack && v >= kSlack && u + v <= 1 - kSlack && std::abs(t) < best) {
      best = std::abs(t);
      out = p + t * line;
    }
  });
  return out;
}

}  // namespace dubsar::bench
