// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_merge.h"

#include <algorithm>
#include <tuple>

#include "bench/support/link_faces.h"
#include "bench/support/link_pairs.h"
#include "bench/support/link_projection.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector3f;

constexpr std::uint32_t kNone = 0xffffffffU;

/// The vertices of M, then those of M'.
class Merger {
 public:
  Merger(const LinkMesh& m, const LinkMesh& m2, const LinkMergeOptions& options)
      : sides_{&m, &m2},
        options_(options),
        first_of_second_(static_cast<std::uint32_t>(m.positions.size())) {}

  LinkMerge run();

 private:
  [[nodiscard]] std::size_t side(std::uint32_t v) const { return v < first_of_second_ ? 0 : 1; }
  [[nodiscard]] std::uint32_t own(std::uint32_t v) const { return v - (side(v) == 0 ? 0 : first_of_second_); }
  [[nodiscard]] const LinkMesh& mesh(std::uint32_t v) const { return *sides_[side(v)]; }
  [[nodiscard]] std::size_t count() const {
    return sides_[0]->positions.size() + sides_[1]->positions.size();
  }
  void find_pairs();
  void find_standing();
  void move_standing(LinkMesh& all) const;
  [[nodiscard]] std::vector<LinkEdge> merge_edges(const LinkMesh& all, std::size_t& conforming) const;

  std::array<const LinkMesh*, 2> sides_;
  LinkMergeOptions options_;
  std::uint32_t first_of_second_;
  std::vector<std::uint32_t> pair_;      ///< closest of the other mesh, or kNone
  std::vector<std::uint32_t> standing_;  ///< the vertex of the result that stands for each
  std::size_t mutual_ = 0;
};

void Merger::find_pairs() {
  pair_.assign(count(), kNone);
  for (std::size_t s = 0; s < 2; ++s) {
    const auto closest = closest_vertices(*sides_[s], *sides_[1 - s], options_.reach);
    const std::uint32_t from = s == 0 ? 0 : first_of_second_, to = first_of_second_ - from;
    for (std::size_t v = 0; v < closest.size(); ++v) {
      if (closest[v] >= 0) {
        pair_[from + v] = to + static_cast<std::uint32_t>(closest[v]);
      }
    }
  }
  for (std::uint32_t v = 0; v < first_of_second_; ++v) {
    mutual_ += pair_[v] != kNone && pair_[pair_[v]] == v ? 1 : 0;
  }
}

void Merger::find_standing() {
  const std::array boundary = {neighbours_of(*sides_[0]).is_boundary, neighbours_of(*sides_[1]).is_boundary};
  // A boundary point takes the topology of the other.
  const auto key = [&](std::uint32_t v) {
    return std::tuple(boundary[side(v)][own(v)] == 0, mesh(v).reliability[own(v)], side(v) == 0);
  };
  std::vector<std::uint32_t> next(count(), kNone);
  parallel_for_each_index(next.size(), [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i);
    if (pair_[v] != kNone && (!options_.one_to_one || pair_[pair_[v]] == v) && key(pair_[v]) > key(v)) {
      next[v] = pair_[v];
    }
  });
  standing_.resize(count());
  parallel_for_each_index(next.size(), [&](std::size_t i) {
    auto v = static_cast<std::uint32_t>(i);
    while (next[v] != kNone) {  // each more reliable than the one before: it ends
      v = next[v];
    }
    standing_[i] = v;
  });
}

void Merger::move_standing(LinkMesh& all) const {
  const std::array projectors = {LinkProjector(*sides_[0]), LinkProjector(*sides_[1])};
  parallel_for_each_index(count(), [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i);
    if (standing_[v] != v || pair_[v] == kNone) {
      return;
    }
    const std::uint32_t w = pair_[v];
    const LinkProjector& on = projectors[side(w)];
    const Vector3f p = all.positions[v];
    const auto projected = on.along(p, all.to_scanner[v], own(w), options_.reach.all_mm);
    if (projected) {
      const float a = mesh(v).weight[own(v)], b = mesh(w).weight[own(w)];
      all.positions[v] = (a * p + b * *projected) / (a + b);
      all.weight[v] = a + b;
    }
  });
}

std::vector<LinkEdge> Merger::merge_edges(const LinkMesh& all, std::size_t& conforming) const {
  struct Seen {
    std::uint32_t a, b;
    std::uint8_t in;  ///< 1 for M, 2 for M'
  };
  std::vector<Seen> seen(3 * all.faces.size());
  parallel_for_each_index(all.faces.size(), [&](std::size_t f) {
    const std::uint8_t in = side(all.faces[f][0]) == 0 ? 1 : 2;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = standing_[all.faces[f][k]], b = standing_[all.faces[f][(k + 1) % 3]];
      seen[3 * f + k] = {std::min(a, b), std::max(a, b), in};
    }
  });
  std::erase_if(seen, [](const Seen& s) { return s.a == s.b; });
  parallel_sort(seen.begin(), seen.end(), [](const Seen& x, const Seen& y) {
    return std::tuple(x.a, x.b, x.in) < std::tuple(y.a, y.b, y.in);
  });
  std::vector<LinkEdge> out;
  for (std::size_t i = 0; i < seen.size();) {
    const std::uint32_t a = seen[i].a, b = seen[i].b;
    std::uint8_t in = 0;
    for (; i < seen.size() && seen[i].a == a && seen[i].b == b; ++i) {
      in |= seen[i].in;
    }
    conforming += in == 3 ? 1 : 0;
    // Seen from either end: does the mesh that the vertex is of have the edge? That one's vertex is the more
    // reliable of the pair. Case 1 is an edge of the other mesh at a vertex, case 2 one of its own.
    const auto has = [&](std::uint32_t v) { return (in & (side(v) == 0 ? 1 : 2)) != 0; };
    if (has(a) && has(b)) {
      out.push_back({{a, b}});
    } else if (has(a) != has(b)) {
      // Associated with the mesh in which the two are not connected: that of the end that does not have it.
      out.push_back({{a, b}, true, true, all.to_scanner[has(a) ? b : a]});
    }
  }
  return out;
}

/// Both, side by side.
LinkMesh joined(const LinkMesh& m, const LinkMesh& m2) {
  LinkMesh out = m;
  const auto append = [](auto& to, const auto& more) { to.insert(to.end(), more.begin(), more.end()); };
  const auto base = static_cast<std::uint32_t>(m.positions.size());
  append(out.positions, m2.positions);
  append(out.normals, m2.normals);
  append(out.to_scanner, m2.to_scanner);
  append(out.reliability, m2.reliability);
  append(out.weight, m2.weight);
  for (const auto& f : m2.faces) {
    out.faces.push_back({base + f[0], base + f[1], base + f[2]});
  }
  return out;
}

void drop_unused(LinkMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (const auto& f : mesh.faces) {
    for (const std::uint32_t v : f) {
      number[v] = 0;
    }
  }
  std::uint32_t used = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] != kNone) {
      mesh.positions[used] = mesh.positions[v];
      mesh.normals[used] = mesh.normals[v];
      mesh.to_scanner[used] = mesh.to_scanner[v];
      mesh.reliability[used] = mesh.reliability[v];
      mesh.weight[used] = mesh.weight[v];
      number[v] = used++;
    }
  }
  mesh.positions.resize(used);
  mesh.normals.resize(used);
  mesh.to_scanner.resize(used);
  mesh.reliability.resize(used);
  mesh.weight.resize(used);
  for (auto& f : mesh.faces) {
    for (std::uint32_t& v : f) {
      v = number[v];
    }
  }
}

LinkMerge Merger::run() {
  find_pairs();
  find_standing();
  LinkMerge out;
  LinkMesh& all = out.mesh;
  all = joined(*sides_[0], *sides_[1]);
  move_standing(all);
  out.pairs = mutual_;
  std::vector<LinkEdge> edges = merge_edges(all, out.conforming);
  out.edges = resolve_weak_edges(all.positions, all.normals, edges);
  std::vector<std::array<std::uint32_t, 2>> kept;
  for (const LinkEdge& e : edges) {
    if (e.is_kept) {
      kept.push_back(e.ends);
    }
  }
  all.faces = faces_of_links(all.positions, all.to_scanner, kept);
  drop_unused(all);
  return out;
}

}  // namespace

LinkMerge merge_links(const LinkMesh& m, const LinkMesh& m2, const LinkMergeOptions& options) {
  return Merger(m, m2, options).run();
}

}  // namespace dubsar::bench
