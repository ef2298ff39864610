// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/manifold.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "core/parallel.h"
#include "core/parallel_erase.h"
#include "triangulation/vertex_fans.h"

namespace dubsar {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kGrain = 16384;
constexpr std::size_t kVerticesPerChunk = 4096;

bool has_repeated_half_edge(const HalfEdges& edges) {
  return parallel_reduce_ordered(
      edges.vertex_count(), kVerticesPerChunk, false,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const auto a = static_cast<std::uint32_t>(v);
          if (std::ranges::any_of(edges.from(a), [&](const HalfEdges::Out& out) {
                return edges.face(a, out.to) != static_cast<std::int64_t>(out.face);
              })) {
            return true;
          }
        }
        return false;
      },
      [](bool& total, bool part) { total = total || part; });
}

/// Of faces that run along the same half-edge the first stays.
void drop_repeated_half_edges(const HalfEdges& edges, std::vector<Triangle>& faces) {
  std::vector<std::uint8_t> gone(faces.size(), 0);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edges.any_face(faces[i][k], faces[i][(k + 1) % 3],
                         [&](std::uint32_t other) { return other < i && gone[other] == 0; })) {
        gone[i] = 1;
      }
    }
  }
  std::size_t at = 0;
  std::erase_if(faces, [&](const Triangle&) { return gone[at++] != 0; });
}

/// Gives each fan but the first of the vertices that have several a vertex of its own; returns what each of
/// those, numbered on from vertex_count, copies.
std::vector<std::uint32_t> split_fans(std::vector<Triangle>& faces, const HalfEdges& edges) {
  const std::size_t vertex_count = edges.vertex_count();
  std::vector<std::uint8_t> pinched(vertex_count, 0);
  parallel_chunks(vertex_count, kVerticesPerChunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> fan;
    for (std::size_t v = begin; v < end; ++v) {
      pinched[v] = number_fans(faces, edges, static_cast<std::uint32_t>(v), fan) > 1 ? 1 : 0;
    }
  });
  struct Replacement {
    std::uint32_t face, corner, vertex;
  };
  std::vector<Replacement> replacements;  // fans are told apart by what the faces were
  std::vector<std::uint32_t> copies;
  std::vector<std::uint32_t> fan;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (pinched[v] == 0) {
      continue;
    }
    const std::uint32_t fans = number_fans(faces, edges, v, fan);
    const auto first_copy = static_cast<std::uint32_t>(vertex_count + copies.size());
    copies.insert(copies.end(), fans - 1, v);
    for (std::size_t o = 0; o < fan.size(); ++o) {
      if (fan[o] > 0) {
        const std::uint32_t face = edges.from(v)[o].face;
        const auto corner = static_cast<std::uint32_t>(corner_of(faces[face], v));
        replacements.push_back({face, corner, first_copy + fan[o] - 1});
      }
    }
  }
  for (const auto& [face, corner, vertex] : replacements) {
    faces[face][corner] = vertex;
  }
  return copies;
}

/// Keeps entry i where keep[i] != 0; empty arrays stay empty.
template <class T>
void keep_entries(std::vector<T>& values, const std::vector<std::uint32_t>& target) {
  if (values.empty()) {
    return;
  }
  std::size_t out = 0;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] != kNone) {
      values[out++] = values[i];
    }
  }
  values.resize(out);
}

}  // namespace

std::vector<std::uint32_t> make_manifold(std::vector<Triangle>& faces, std::size_t vertex_count,
                                         std::span<const std::uint8_t> only, const JobContext& job) {
  erase_where(faces, [](const Triangle& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  HalfEdges edges(faces, vertex_count, only, job);
  if (!job.cancelled() && has_repeated_half_edge(edges)) {
    drop_repeated_half_edges(edges, faces);
    edges = HalfEdges(faces, vertex_count, only, job);
  }
  return job.cancelled() ? std::vector<std::uint32_t>{} : split_fans(faces, edges);
}

void compact_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> target(mesh.positions.size(), kNone);
  parallel_ranges(target.size(), [&](std::size_t begin, std::size_t end) {
    for (const Triangle& f : mesh.faces) {
      for (const std::uint32_t v : f) {
        if (v >= begin && v < end) {
          target[v] = 0;
        }
      }
    }
  });
  std::uint32_t count = 0;
  for (std::uint32_t& t : target) {
    if (t != kNone) {
      t = count++;
    }
  }
  if (count == target.size()) {
    return;
  }
  const std::array<std::function<void()>, 7> arrays = {
      [&] { keep_entries(mesh.positions, target); },   [&] { keep_entries(mesh.normals, target); },
      [&] { keep_entries(mesh.reliability, target); }, [&] { keep_entries(mesh.sigma_mm, target); },
      [&] { keep_entries(mesh.scans, target); },       [&] { keep_entries(mesh.flags, target); },
      [&] { keep_entries(mesh.colours, target); }};
  parallel_for_each_index(
      arrays.size(), [&](std::size_t k) { arrays[k](); }, 1);
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        for (std::uint32_t& v : mesh.faces[i]) {
          v = target[v];
        }
      },
      kGrain);
}

}  // namespace dubsar
