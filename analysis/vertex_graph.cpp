// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/vertex_graph.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "core/big_array.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

using Face = std::array<std::uint32_t, 3>;
constexpr std::size_t kGrain = 1U << 14U;

bool usable(const Face& f, std::uint32_t vertices) {
  return f[0] < vertices && f[1] < vertices && f[2] < vertices && f[0] != f[1] && f[1] != f[2] &&
         f[2] != f[0];
}

bool has(const Face& f, std::uint32_t v) {
  return f[0] == v || f[1] == v || f[2] == v;
}

/// start[v + 1] holds counts on entry, places on return.
void sum_up(std::vector<std::uint32_t>& start) {
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start) {
    sum += s;
    s = sum;
  }
}

/// Every face at each of its vertices; ascending, because the order of the threads must not show.
void collect_faces(const Mesh& mesh, std::vector<std::uint32_t>& start, BigArray<std::uint32_t>& face) {
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  start.assign(std::size_t{vertices} + 1, 0);
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        if (usable(mesh.faces[i], vertices)) {
          for (const std::uint32_t v : mesh.faces[i]) {
            std::atomic_ref(start[v + 1]).fetch_add(1, std::memory_order_relaxed);
          }
        }
      },
      kGrain);
  sum_up(start);
  face = BigArray<std::uint32_t>(start.back());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        if (usable(mesh.faces[i], vertices)) {
          for (const std::uint32_t v : mesh.faces[i]) {
            face[std::atomic_ref(next[v]).fetch_add(1, std::memory_order_relaxed)] =
                static_cast<std::uint32_t>(i);
          }
        }
      },
      kGrain);
}

Face sorted_corners(const Face& f) {
  Face sorted = f;
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// As sort_distinct(), for the hub of a fan of thousands.
std::uint32_t sort_distinct_of_many(const Mesh& mesh, std::uint32_t* begin, std::uint32_t* end) {
  std::vector<std::pair<Face, std::uint32_t>> known;
  for (const std::uint32_t* i = begin; i != end; ++i) {
    known.emplace_back(sorted_corners(mesh.faces[*i]), *i);
  }
  std::sort(known.begin(), known.end());
  const auto last = std::unique(known.begin(), known.end(),
                                [](const auto& a, const auto& b) { return a.first == b.first; });
  std::uint32_t* out = begin;
  for (auto k = known.begin(); k != last; ++k) {
    *out++ = k->second;
  }
  std::sort(begin, out);
  return static_cast<std::uint32_t>(out - begin);
}

/// Sorts the faces at v and takes out those on the same three vertices as an earlier one. Their number.
std::uint32_t sort_distinct(const Mesh& mesh, std::uint32_t* begin, std::uint32_t* end) {
  constexpr std::ptrdiff_t kMany = 32;
  if (end - begin > kMany) {
    return sort_distinct_of_many(mesh, begin, end);
  }
  std::sort(begin, end);
  std::uint32_t* out = begin;
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const Face& f = mesh.faces[*i];
    const bool again = std::any_of(begin, out, [&](std::uint32_t j) {
      const Face& g = mesh.faces[j];
      return has(g, f[0]) && has(g, f[1]) && has(g, f[2]);
    });
    if (!again) {
      *out++ = *i;
    }
  }
  return static_cast<std::uint32_t>(out - begin);
}

/// The vertices beside v in its faces, ascending, into ring (room for two a face). Their number.
std::uint32_t ring_of(const Mesh& mesh, std::uint32_t v, const std::uint32_t* face, std::uint32_t count,
                      std::vector<std::uint32_t>& ring) {
  ring.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const std::uint32_t w : mesh.faces[face[i]]) {
      if (w != v) {
        ring.push_back(w);
      }
    }
  }
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return static_cast<std::uint32_t>(ring.size());
}

}  // namespace

VertexGraph make_vertex_graph(const Mesh& mesh) {
  VertexGraph graph;
  const std::size_t vertices = mesh.positions.size();
  std::vector<std::uint32_t> raw_start;
  BigArray<std::uint32_t> raw;
  collect_faces(mesh, raw_start, raw);
  graph.start.assign(vertices + 1, 0);
  graph.face_start.assign(vertices + 1, 0);
  // The rings are written over the pairs of the faces, two places each, and moved together afterwards.
  BigArray<std::uint32_t> wide(2 * std::size_t{raw_start.back()});
  parallel_chunks(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> ring;
    for (std::size_t v = begin; v < end; ++v) {
      std::uint32_t* const faces = raw_start[v] == raw_start[v + 1] ? nullptr : &raw[raw_start[v]];
      const std::uint32_t count =
          faces == nullptr ? 0 : sort_distinct(mesh, faces, faces + (raw_start[v + 1] - raw_start[v]));
      graph.face_start[v + 1] = count;
      graph.start[v + 1] = ring_of(mesh, static_cast<std::uint32_t>(v), faces, count, ring);
      if (!ring.empty()) {
        std::copy(ring.begin(), ring.end(), &wide[2 * std::size_t{raw_start[v]}]);
      }
    }
  });
  sum_up(graph.start);
  sum_up(graph.face_start);
  graph.neighbour.resize(graph.start.back());
  graph.face.resize(graph.face_start.back());
  parallel_for_each_index(
      vertices,
      [&](std::size_t v) {
        const std::uint32_t faces = graph.face_start[v + 1] - graph.face_start[v];
        if (faces > 0) {
          std::copy_n(&raw[raw_start[v]], faces, &graph.face[graph.face_start[v]]);
          std::copy_n(&wide[2 * std::size_t{raw_start[v]}], graph.start[v + 1] - graph.start[v],
                      &graph.neighbour[graph.start[v]]);
        }
      },
      kGrain);
  return graph;
}

}  // namespace dubsar
