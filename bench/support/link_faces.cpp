// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector3f;

constexpr std::uint32_t kNone = 0xffffffffU;

struct Links {
  std::vector<std::uint32_t> first;   ///< [V + 1]
  std::vector<std::uint32_t> others;  ///< by vertex, counter-clockwise
  std::vector<std::uint32_t> next;    ///< by place in others: who follows less than half a turn on, or kNone

  /// Who follows `other` in the link of v.
  [[nodiscard]] std::uint32_t after(std::uint32_t v, std::uint32_t other) const {
    for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) {
      if (others[k] == other) {
        return next[k];
      }
    }
    return kNone;
  }
};

Links unordered_links(std::size_t vertices, std::span<const std::array<std::uint32_t, 2>> edges) {
  Links out;
  out.first.assign(vertices + 1, 0);
  for (const auto& e : edges) {
    ++out.first[e[0] + 1];
    ++out.first[e[1] + 1];
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    out.first[v + 1] += out.first[v];
  }
  out.others.resize(2 * edges.size());
  out.next.resize(2 * edges.size());
  std::vector<std::uint32_t> at(out.first.begin(), out.first.end() - 1);
  for (const auto& e : edges) {
    out.others[at[e[0]]++] = e[1];
    out.others[at[e[1]]++] = e[0];
  }
  return out;
}

void order_link(std::span<const Vector3f> positions, const Vector3f& axis, std::uint32_t v, Links& links) {
  struct Direction {
    float x, y, turn;
    std::uint32_t other;
  };
  const std::uint32_t begin = links.first[v];
  const std::uint32_t count = links.first[v + 1] - begin;
  const Vector3f x = axis.unitOrthogonal();
  const Vector3f y = axis.cross(x);
  std::vector<Direction> around(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t other = links.others[begin + k];
    const Vector3f d = positions[other] - positions[v];
    const float dx = x.dot(d), dy = y.dot(d);
    around[k] = {dx, dy, std::atan2(dy, dx), other};
  }
  std::ranges::sort(around, [](const Direction& a, const Direction& b) {
    return a.turn != b.turn ? a.turn < b.turn : a.other < b.other;
  });
  for (std::uint32_t k = 0; k < count; ++k) {
    const Direction& here = around[k];
    const Direction& following = around[(k + 1) % count];
    links.others[begin + k] = here.other;
    links.next[begin + k] = here.x * following.y - here.y * following.x > 0 ? following.other : kNone;
  }
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> faces_of_links(
    std::span<const Vector3f> positions, std::span<const Vector3f> axes,
    std::span<const std::array<std::uint32_t, 2>> edges) {
  Links links = unordered_links(positions.size(), edges);
  parallel_for_each_index(positions.size(), [&](std::size_t v) {
    order_link(positions, axes[v], static_cast<std::uint32_t>(v), links);
  });
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t a = 0; a < positions.size(); ++a) {
    for (std::uint32_t k = links.first[a]; k < links.first[a + 1]; ++k) {
      const std::uint32_t b = links.others[k], c = links.next[k];
      if (b > a && c != kNone && c > a && links.after(b, c) == a && links.after(c, a) == b) {
        faces.push_back({a, b, c});
      }
    }
  }
  return faces;
}

}  // namespace dubsar::bench
