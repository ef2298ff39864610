// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/reliability.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <tuple>

#include "core/parallel.h"

namespace dubsar {
namespace {

constexpr std::size_t kGrain = 1U << 14U;

/// The edge opposite to a vertex in one of its faces.
struct Opposite {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t face = 0;
};

void mark(std::vector<std::uint8_t>& marks, std::uint32_t face) {
  std::atomic_ref(marks[face]).store(1, std::memory_order_relaxed);
}

void opposites_of(const Mesh& mesh, const VertexGraph& graph, std::uint32_t v, std::vector<Opposite>& out) {
  out.clear();
  for (const std::uint32_t face : graph.faces_at(v)) {
    const auto& f = mesh.faces[face];
    const std::size_t k = f[0] == v ? 0 : f[1] == v ? 1 : 2;
    out.push_back({f[(k + 1) % 3], f[(k + 2) % 3], face});
  }
}

/// The faces around one vertex by the edges opposite to it.
class Fan {
 public:
  explicit Fan(std::vector<Opposite>& around) : around_(around) {
    if (around_.size() > kMany) {  // the hub of a fan of thousands
      std::sort(around_.begin(), around_.end(), [](const Opposite& a, const Opposite& b) {
        return std::tie(a.from, a.face) < std::tie(b.from, b.face);
      });
      for (const Opposite& o : around_) {
        ends_.push_back(o.to);
      }
      std::sort(ends_.begin(), ends_.end());
    }
  }
  [[nodiscard]] std::ptrdiff_t leaving(std::uint32_t w) const {
    if (ends_.empty()) {
      return std::count_if(around_.begin(), around_.end(), [&](const Opposite& o) { return o.from == w; });
    }
    const auto [first, last] = std::equal_range(around_.begin(), around_.end(), Opposite{w, 0, 0}, by_from);
    return last - first;
  }
  [[nodiscard]] std::ptrdiff_t entering(std::uint32_t w) const {
    if (ends_.empty()) {
      return std::count_if(around_.begin(), around_.end(), [&](const Opposite& o) { return o.to == w; });
    }
    const auto [first, last] = std::equal_range(ends_.begin(), ends_.end(), w);
    return last - first;
  }
  /// The face that leaves w, or null.
  [[nodiscard]] const Opposite* from(std::uint32_t w) const {
    const auto at =
        ends_.empty()
            ? std::find_if(around_.begin(), around_.end(), [&](const Opposite& o) { return o.from == w; })
            : std::lower_bound(around_.begin(), around_.end(), Opposite{w, 0, 0}, by_from);
    return at == around_.end() || at->from != w ? nullptr : &*at;
  }

 private:
  static constexpr std::size_t kMany = 32;
  static bool by_from(const Opposite& a, const Opposite& b) { return a.from < b.from; }
  std::vector<Opposite>& around_;
  std::vector<std::uint32_t> ends_;  ///< only of many
};

/// Whether the faces make one fan, closed or from an open edge to another; marks those along open edges.
bool is_one_fan(std::vector<Opposite>& around, std::vector<std::uint8_t>& faulty) {
  const Fan fan(around);
  std::size_t first = 0;
  std::size_t open_starts = 0;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Opposite& o = around[i];
    if (fan.leaving(o.from) != 1 || fan.entering(o.to) != 1) {
      return false;
    }
    if (fan.entering(o.from) == 0) {
      first = i;
      ++open_starts;
      mark(faulty, o.face);
    }
    if (fan.leaving(o.to) == 0) {
      mark(faulty, o.face);
    }
  }
  if (open_starts > 1) {
    return false;
  }
  std::size_t seen = 1;
  std::uint32_t next = around[first].to;
  while (next != around[first].from && seen <= around.size()) {
    const Opposite* const on = fan.from(next);
    if (on == nullptr) {
      break;
    }
    next = on->to;
    ++seen;
  }
  return seen == around.size();
}

/// Marks what is wrong with the faces at v: those along an open edge, or all where they make no single fan.
void mark_faults(const Mesh& mesh, const VertexGraph& graph, std::uint32_t v, std::vector<Opposite>& around,
                 std::vector<std::uint8_t>& faulty) {
  opposites_of(mesh, graph, v, around);
  if (!around.empty() && !is_one_fan(around, faulty)) {
    for (const Opposite& o : around) {
      mark(faulty, o.face);
    }
  }
}

/// Grows a set of faces over the 1-ring; each vertex hands on to its faces once.
class Spread {
 public:
  Spread(const Mesh& mesh, const VertexGraph& graph)
      : mesh_(mesh), graph_(graph), handed_on_(graph.vertex_count(), 0) {}

  /// The faces that share a vertex with `frontier`, are not yet in `reached`, and may be; put into it.
  template <class May>
  std::vector<std::uint32_t> step(const std::vector<std::uint32_t>& frontier,
                                  std::vector<std::uint8_t>& reached, const May& may) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t face : frontier) {
      for (const std::uint32_t v : mesh_.faces[face]) {
        if (handed_on_[v] != 0) {
          continue;
        }
        handed_on_[v] = 1;
        for (const std::uint32_t f : graph_.faces_at(v)) {
          if (reached[f] == 0 && may(f)) {
            reached[f] = 1;
            next.push_back(f);
          }
        }
      }
    }
    return next;
  }

 private:
  const Mesh& mesh_;
  const VertexGraph& graph_;
  std::vector<std::uint8_t> handed_on_;
};

/// The faces of `selected` that share a vertex with one that is not.
std::vector<std::uint32_t> rim_of(const Mesh& mesh, const VertexGraph& graph,
                                  const std::vector<std::uint32_t>& selected,
                                  const std::vector<std::uint8_t>& is_selected) {
  enum : std::uint8_t { kUnknown, kInside, kAtRim };
  std::vector<std::uint8_t> known(graph.vertex_count(), kUnknown);
  const auto at_rim = [&](std::uint32_t v) {
    if (known[v] == kUnknown) {
      const auto faces = graph.faces_at(v);
      const bool rim =
          std::any_of(faces.begin(), faces.end(), [&](std::uint32_t f) { return is_selected[f] == 0; });
      known[v] = rim ? kAtRim : kInside;
    }
    return known[v] == kAtRim;
  };
  std::vector<std::uint32_t> rim;
  for (const std::uint32_t f : selected) {
    if (std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(), at_rim)) {
      rim.push_back(f);
    }
  }
  return rim;
}

/// [F] by face: 0 kept to the end or deselected last … n + 1 never selected, in units of 1 / (n + 1).
std::vector<std::uint8_t> face_ranks(const Mesh& mesh, const VertexGraph& graph,
                                     std::vector<std::uint8_t> is_selected, int iterations) {
  std::vector<std::uint8_t> rank(mesh.faces.size(), static_cast<std::uint8_t>(iterations + 1));
  std::vector<std::uint32_t> selected;
  for (std::size_t f = 0; f < is_selected.size(); ++f) {
    if (is_selected[f] != 0) {
      selected.push_back(static_cast<std::uint32_t>(f));
    }
  }
  if (selected.empty()) {
    return rank;
  }
  Spread dilation(mesh, graph);
  std::vector<std::uint32_t> frontier = selected;
  for (int i = 0; i < iterations; ++i) {
    frontier = dilation.step(frontier, is_selected, [](std::uint32_t) { return true; });
    selected.insert(selected.end(), frontier.begin(), frontier.end());
  }
  for (const std::uint32_t f : selected) {
    rank[f] = 0;
  }
  // Erosion from outside: first the selected faces that touch one that is not, then those that touch these.
  std::vector<std::uint8_t> gone(mesh.faces.size(), 0);
  frontier = rim_of(mesh, graph, selected, is_selected);
  for (const std::uint32_t f : frontier) {
    gone[f] = 1;
  }
  Spread erosion(mesh, graph);
  for (int i = 1; i <= iterations + 1; ++i) {
    for (const std::uint32_t f : frontier) {
      rank[f] = static_cast<std::uint8_t>(iterations + 1 - i);
    }
    frontier = erosion.step(frontier, gone, [&](std::uint32_t f) { return is_selected[f] != 0; });
  }
  return rank;
}

}  // namespace

std::vector<float> vertex_reliability(const Mesh& mesh, const VertexGraph& graph, int iterations) {
  iterations = std::clamp(iterations, 0, 200);
  std::vector<std::uint8_t> faulty(mesh.faces.size(), 0);
  parallel_chunks(graph.vertex_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Opposite> around;
    for (std::size_t v = begin; v < end; ++v) {
      mark_faults(mesh, graph, static_cast<std::uint32_t>(v), around, faulty);
    }
  });
  const std::vector<std::uint8_t> rank = face_ranks(mesh, graph, std::move(faulty), iterations);
  std::vector<float> reliability(graph.vertex_count(), 0.0F);
  parallel_for_each_index(
      reliability.size(),
      [&](std::size_t v) {
        const auto faces = graph.faces_at(static_cast<std::uint32_t>(v));
        int least = faces.empty() ? 0 : iterations + 1;
        for (const std::uint32_t f : faces) {
          least = std::min<int>(least, rank[f]);
        }
        // What is no share of one is as the reader of files has it: one vertex that is no number would cost
        // the wedge that it lies in, and one below zero turn its faces.
        const float given = mesh.reliability.empty() ? 1.0F : mesh.reliability[v];
        const float own = given > 0 ? std::min(given, 1.0F) : 0.0F;
        reliability[v] = own * static_cast<float>(least) / static_cast<float>(iterations + 1);
      },
      kGrain);
  return reliability;
}

}  // namespace dubsar
