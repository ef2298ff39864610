// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/job.h"

namespace dubsar {

using Triangle = std::array<std::uint32_t, 3>;

/// The corner of the face at which it touches the vertex.
[[nodiscard]] inline int corner_of(const Triangle& face, std::uint32_t vertex) {
  return face[0] == vertex ? 0 : face[1] == vertex ? 1 : 2;
}

/// Half-edges that leave each vertex, in compressed rows: for face f and corner k the half-edge from corner k
/// to the next one. Faces must have indices below the vertex count. With `only` given, no more than those
/// that leave vertices v with only[v] != 0. Of a job that is cancelled while they are gathered there are
/// none.
class HalfEdges {
 public:
  struct Out {
    std::uint32_t to = 0;    ///< the vertex it runs to
    std::uint32_t face = 0;  ///< the face on its left
  };

  HalfEdges(std::span<const Triangle> faces, std::size_t vertex_count,
            std::span<const std::uint8_t> only = {}, const JobContext& job = {});

  [[nodiscard]] std::span<const Out> from(std::uint32_t vertex) const {
    return {out_.data() + start_[vertex], out_.data() + start_[vertex + 1]};
  }
  /// Whether test(face) holds for one of the faces that run from a to b, the lowest first.
  template <class Test>
  [[nodiscard]] bool any_face(std::uint32_t a, std::uint32_t b, const Test& test) const {
    return std::ranges::any_of(among(a, b), [&](const Out& out) { return out.to == b && test(out.face); });
  }
  /// How many faces run from a to b.
  [[nodiscard]] int count(std::uint32_t a, std::uint32_t b) const;
  /// The lowest face that runs from a to b, or -1.
  [[nodiscard]] std::int64_t face(std::uint32_t a, std::uint32_t b) const;
  /// The one face at the edge between two vertices, whichever way it runs: an edge of the boundary.
  [[nodiscard]] bool is_open(std::uint32_t a, std::uint32_t b) const {
    return count(a, b) + count(b, a) == 1;
  }
  /// The face that a face goes on into across its edge from a to b, or -1. Of two faces it is the other,
  /// whichever way that one runs; of more the n-th that runs from a to b goes on into the n-th that runs from
  /// b to a, and the other way round, so that no face is come to from two.
  [[nodiscard]] std::int64_t across(std::uint32_t face, std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] std::size_t vertex_count() const { return start_.size() - 1; }

  /// Of so many half-edges around a vertex one is found by looking at them all.
  static constexpr std::size_t kFew = 32;

 private:
  /// Half-edges that leave a, all those to b among them, the lowest face first.
  [[nodiscard]] std::span<const Out> among(std::uint32_t a, std::uint32_t b) const {
    const std::span<const Out> outs = from(a);
    return outs.size() <= kFew ? outs : of_crowd(a, b);
  }
  [[nodiscard]] std::span<const Out> of_crowd(std::uint32_t a, std::uint32_t b) const;
  /// How many of the faces that run from a to b come before this one, and which comes after so many, or -1.
  [[nodiscard]] std::size_t rank(std::uint32_t a, std::uint32_t b, std::uint32_t face) const;
  [[nodiscard]] std::int64_t face_of_rank(std::uint32_t a, std::uint32_t b, std::size_t rank) const;
  void sort_crowds(const JobContext& job);

  std::vector<std::uint32_t> start_;
  std::vector<Out> out_;
  /// Of each vertex that more than kFew leave where its half-edges lie in sorted_, by vertex.
  std::vector<std::pair<std::uint32_t, std::size_t>> crowds_;
  std::vector<Out> sorted_;  ///< by the vertex they run to, then by face
};

/// Component number of each face (0, 1, … in order of their first face), faces being joined across the edges
/// that they share, whichever way they run and however many there are. Of a job that is cancelled there are
/// none.
struct FaceComponents {
  std::vector<std::uint32_t> of_face;
  std::vector<std::size_t> sizes;  ///< faces per component
};
[[nodiscard]] FaceComponents face_components(std::span<const Triangle> faces, const HalfEdges& edges,
                                             const JobContext& job = {});

/// 1 for each vertex on an open edge (a half-edge a→b of a face while no face has b→a), 0 for each whose
/// faces close around it: one pass that tells apart the few vertices where something can be wrong. Heads and
/// tails around a vertex are compared by sums of 64-bit hashes.
[[nodiscard]] std::vector<std::uint8_t> rim_vertices(std::span<const Triangle> faces,
                                                     std::size_t vertex_count);

/// A walk along edges of the boundary, those with a single face.
struct BoundaryLoop {
  std::vector<std::uint32_t> vertices;
  /// It comes back to its first vertex; if not, it ends where more than two faces meet in an edge.
  bool closed = true;
};

/// Each edge of the boundary is in one of them, once. The first edge of a walk is gone in the direction of
/// the face beside it, as all others are where faces are turned the same way. Where fans touch in one vertex
/// each walk stays with its own fan. Time is that of the faces around the boundary. Of a job that is
/// cancelled some are missing.
[[nodiscard]] std::vector<BoundaryLoop> boundary_loops(std::span<const Triangle> faces,
                                                       const HalfEdges& edges, const JobContext& job = {});

}  // namespace dubsar
