// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/weak_edges.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/parallel.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

float cross(const Vector2f& a, const Vector2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool cross_each_other(const Vector2f& a, const Vector2f& b, const Vector2f& c, const Vector2f& d) {
  const float ac = cross(b - a, c - a), ad = cross(b - a, d - a);
  const float ca = cross(d - c, a - c), cb = cross(d - c, b - c);
  return ((ac > 0 && ad < 0) || (ac < 0 && ad > 0)) && ((ca > 0 && cb < 0) || (ca < 0 && cb > 0));
}

class SecondPass {
 public:
  SecondPass(std::span<const Vector3f> positions, std::span<const Vector3f> normals,
             std::vector<LinkEdge>& edges)
      : positions_(positions), normals_(normals), edges_(edges), first_(positions.size() + 1) {
    for (const LinkEdge& e : edges) {
      ++first_[e.ends[0] + 1];
      ++first_[e.ends[1] + 1];
    }
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) {
      first_[v + 1] += first_[v];
    }
    std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
    incident_.resize(2 * edges.size());
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      incident_[at[edges[e].ends[0]]++] = e;
      incident_[at[edges[e].ends[1]]++] = e;
    }
  }

  WeakEdgeCounts run();

 private:
  /// Those that an edge crosses in its plane, each once.
  [[nodiscard]] std::vector<std::uint32_t> crossed_by(const LinkEdge& edge) const;
  /// Lower stays.
  [[nodiscard]] std::array<float, 2> rank(const LinkEdge& e) const {
    return {1 - normals_[e.ends[0]].dot(normals_[e.ends[1]]),
            (positions_[e.ends[0]] - positions_[e.ends[1]]).squaredNorm()};
  }

  std::span<const Vector3f> positions_, normals_;
  std::vector<LinkEdge>& edges_;
  std::vector<std::uint32_t> first_, incident_;  ///< by vertex: its edges
};

std::vector<std::uint32_t> SecondPass::crossed_by(const LinkEdge& edge) const {
  std::vector<std::uint32_t> vertices(edge.ends.begin(), edge.ends.end());
  std::size_t begin = 0;
  for (int step = 0; step < 2; ++step) {
    const std::size_t end = vertices.size();
    for (; begin < end; ++begin) {
      for (std::uint32_t k = first_[vertices[begin]]; k < first_[vertices[begin] + 1]; ++k) {
        const auto& ends = edges_[incident_[k]].ends;
        vertices.push_back(ends[0] == vertices[begin] ? ends[1] : ends[0]);
      }
    }
    std::sort(vertices.begin() + static_cast<std::ptrdiff_t>(end), vertices.end());
    vertices.erase(std::unique(vertices.begin() + static_cast<std::ptrdiff_t>(end), vertices.end()),
                   vertices.end());
  }
  std::vector<std::uint32_t> out;
  for (const std::uint32_t v : vertices) {
    out.insert(out.end(), incident_.begin() + first_[v], incident_.begin() + first_[v + 1]);
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  const Vector3f x = edge.plane.unitOrthogonal();
  const Vector3f y = edge.plane.cross(x);
  const Vector3f origin = positions_[edge.ends[0]];
  const auto flat = [&](std::uint32_t v) {
    const Vector3f d = positions_[v] - origin;
    return Vector2f(x.dot(d), y.dot(d));
  };
  const Vector2f a = flat(edge.ends[0]), b = flat(edge.ends[1]);
  std::erase_if(out, [&](std::uint32_t e) {
    const auto& ends = edges_[e].ends;
    return ends[0] == edge.ends[0] || ends[0] == edge.ends[1] || ends[1] == edge.ends[0] ||
           ends[1] == edge.ends[1] || !cross_each_other(a, b, flat(ends[0]), flat(ends[1]));
  });
  return out;
}

WeakEdgeCounts SecondPass::run() {
  struct Weak {
    std::uint32_t edge = 0;
    std::array<float, 2> rank;
    std::vector<std::uint32_t> crossed{};
  };
  std::vector<Weak> weak;
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    if (edges_[e].is_weak) {
      weak.push_back({e, rank(edges_[e])});
    }
  }
  parallel_for_each_index(weak.size(),
                          [&](std::size_t k) { weak[k].crossed = crossed_by(edges_[weak[k].edge]); });
  WeakEdgeCounts counts;
  counts.weak = weak.size();
  for (const Weak& w : weak) {
    if (std::ranges::any_of(w.crossed, [&](std::uint32_t e) { return !edges_[e].is_weak; })) {
      edges_[w.edge].is_kept = false;
      ++counts.crossed;
    }
  }
  // Two may cross in the plane of one of them only: both then know of it.
  std::vector<std::array<std::uint32_t, 2>> rivals;
  for (const Weak& w : weak) {
    for (const std::uint32_t e : w.crossed) {
      if (edges_[e].is_weak) {
        rivals.push_back({w.edge, e});
        rivals.push_back({e, w.edge});
      }
    }
  }
  std::ranges::sort(rivals);
  std::ranges::sort(weak, [](const Weak& a, const Weak& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.edge < b.edge;
  });
  for (std::size_t k = 0; k < weak.size(); ++k) {
    const std::uint32_t edge = weak[k].edge;
    if (!edges_[edge].is_kept) {
      continue;
    }
    for (auto it = std::ranges::lower_bound(rivals, std::array<std::uint32_t, 2>{edge, 0});
         it != rivals.end() && (*it)[0] == edge; ++it) {
      counts.outdone += edges_[(*it)[1]].is_kept ? 1 : 0;
      edges_[(*it)[1]].is_kept = false;
    }
  }
  return counts;
}

}  // namespace

WeakEdgeCounts resolve_weak_edges(std::span<const Vector3f> positions, std::span<const Vector3f> normals,
                                  std::vector<LinkEdge>& edges) {
  return SecondPass(positions, normals, edges).run();
}

}  // namespace dubsar::bench
