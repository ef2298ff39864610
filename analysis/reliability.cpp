// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/reliability.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

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

/// Marks what is wrong with the faces at v: those along an open edge, or all where they make no single fan.
void mark_faults(const Mesh& mesh, const VertexGraph& graph, std::uint32_t v, std::vector<Opposite>& around,
                 std::vector<std::uint8_t>& faulty) {
  opposites_of(mesh, graph, v, around);
  if (around.empty()) {
    return;
  }
  // Follow the faces from edge to edge: a fan that closes, or one from an open edge to another.
  const auto leaving = [&](std::uint32_t w) {
    return std::count_if(around.begin(), around.end(), [&](const Opposite& o) { return o.from == w; });
  };
  const auto entering = [&](std::uint32_t w) {
    return std::count_if(around.begin(), around.end(), [&](const Opposite& o) { return o.to == w; });
  };
  bool sound = true;
  std::size_t first = 0;
  std::size_t open_starts = 0;
  for (std::size_t i = 0; i < around.size() && sound; ++i) {
    sound = leaving(around[i].from) == 1 && entering(around[i].to) == 1;
    if (sound && entering(around[i].from) == 0) {
      first = i;
      ++open_starts;
      mark(faulty, around[i].face);
    }
    if (sound && leaving(around[i].to) == 0) {
      mark(faulty, around[i].face);
    }
  }
  if (sound && open_starts <= 1) {
    std::size_t seen = 1;
    std::uint32_t next = around[first].to;
    while (next != around[first].from && seen <= around.size()) {
      const auto on =
          std::find_if(around.begin(), around.end(), [&](const Opposite& o) { return o.from == next; });
      if (on == around.end()) {
        break;
      }
      next = on->to;
      ++seen;
    }
    sound = seen == around.size();
  } else {
    sound = false;
  }
  if (!sound) {
    for (const Opposite& o : around) {
      mark(faulty, o.face);
    }
  }
}

/// The faces that share a vertex with `frontier` and are not yet in `reached`, put into it; ascending.
template <class May>
std::vector<std::uint32_t> spread(const Mesh& mesh, const VertexGraph& graph,
                                  const std::vector<std::uint32_t>& frontier,
                                  std::vector<std::uint8_t>& reached, const May& may) {
  std::vector<std::uint32_t> next;
  for (const std::uint32_t face : frontier) {
    for (const std::uint32_t v : mesh.faces[face]) {
      for (const std::uint32_t f : graph.faces_at(v)) {
        if (reached[f] == 0 && may(f)) {
          reached[f] = 1;
          next.push_back(f);
        }
      }
    }
  }
  return next;
}

/// [F] by face: 0 kept to the end or deselected last … n + 1 never selected, in units of 1 / (n + 1).
std::vector<std::uint8_t> face_ranks(const Mesh& mesh, const VertexGraph& graph,
                                     std::vector<std::uint8_t> faulty, int iterations) {
  std::vector<std::uint8_t> rank(mesh.faces.size(), static_cast<std::uint8_t>(iterations + 1));
  std::vector<std::uint32_t> selected;
  for (std::size_t f = 0; f < faulty.size(); ++f) {
    if (faulty[f] != 0) {
      selected.push_back(static_cast<std::uint32_t>(f));
    }
  }
  std::vector<std::uint32_t> frontier = selected;
  for (int i = 0; i < iterations; ++i) {
    frontier = spread(mesh, graph, frontier, faulty, [](std::uint32_t) { return true; });
    selected.insert(selected.end(), frontier.begin(), frontier.end());
  }
  // Erosion from outside: first the selected faces that touch one that is not, then those that touch these.
  for (const std::uint32_t f : selected) {
    rank[f] = 0;
  }
  std::vector<std::uint8_t> gone(mesh.faces.size(), 0);
  frontier.clear();
  for (const std::uint32_t f : selected) {
    const auto touches_outside = [&](std::uint32_t v) {
      const auto faces = graph.faces_at(v);
      return std::any_of(faces.begin(), faces.end(), [&](std::uint32_t g) { return faulty[g] == 0; });
    };
    if (std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(), touches_outside)) {
      gone[f] = 1;
      frontier.push_back(f);
    }
  }
  for (int i = 1; i <= iterations + 1; ++i) {
    for (const std::uint32_t f : frontier) {
      rank[f] = static_cast<std::uint8_t>(iterations + 1 - i);
    }
    frontier = spread(mesh, graph, frontier, gone, [&](std::uint32_t f) { return faulty[f] != 0; });
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
        const float own = mesh.reliability.empty() ? 1.0F : mesh.reliability[v];
        reliability[v] = own * static_cast<float>(least) / static_cast<float>(iterations + 1);
      },
      kGrain);
  return reliability;
}

}  // namespace dubsar
