// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/mesh_reach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <queue>
#include <unordered_set>
#include <utility>
#include <vector>

namespace dubsar {

namespace {

/// Around a hole of a millimetre in a fine mesh; more would be as far as other wedges are.
constexpr std::size_t kMostVertices = 4000;
/// Clay that looks away from `up` by more than 120 degrees (cosine) is of the other side: the way to it leads
/// round a rim, and under the place it lies everywhere.
constexpr double kLooksAway = -0.5;

/// `to`: of each corner from the place, so that its foot is the origin.
bool holds_foot(const std::array<Eigen::Vector3d, 3>& to, const Eigen::Vector3d& up) {
  std::array<double, 3> side{};
  for (std::size_t k = 0; k < 3; ++k) {
    side[k] = to[k].cross(to[(k + 1) % 3]).dot(up);
  }
  const auto [least, most] = std::ranges::minmax(side);
  return (least >= 0 || most <= 0) && least != most;
}

}  // namespace

bool mesh_reaches(const Mesh& mesh, const VertexGraph& graph, std::span<const Eigen::Vector3f> normal,
                  std::span<const std::uint32_t> from, const Eigen::Vector3d& at, const Eigen::Vector3d& up,
                  double near_mm) {
  const auto off = [&](std::uint32_t v) -> Eigen::Vector3d { return mesh.positions[v].cast<double>() - at; };
  const auto aside_mm = [&](std::uint32_t v) {
    const Eigen::Vector3d to = off(v);
    return (to - to.dot(up) * up).norm();
  };
  using Open = std::pair<double, std::uint32_t>;  // nearest first
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  std::unordered_set<std::uint32_t> seen;
  const auto add = [&](std::uint32_t v) {
    if (normal[v].cast<double>().dot(up) > kLooksAway && seen.insert(v).second) {
      open.emplace(aside_mm(v), v);
    }
  };
  const auto nearest = std::ranges::min_element(from, {}, aside_mm);
  if (nearest != from.end()) {
    add(*nearest);
  }
  for (std::size_t count = 0; !open.empty() && count < kMostVertices; ++count) {
    const auto [aside, v] = open.top();
    open.pop();
    if (aside <= near_mm) {
      return true;
    }
    for (const std::uint32_t f : graph.faces_at(v)) {
      const auto& [a, b, c] = mesh.faces[f];
      if (holds_foot({off(a), off(b), off(c)}, up)) {
        return true;
      }
    }
    for (const std::uint32_t n : graph.ring(v)) {
      add(n);
    }
  }
  return false;
}

}  // namespace dubsar
