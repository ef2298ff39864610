// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "triangulation/half_edges.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 16384;

/// An edge of a face: from its corner to the next one.
struct FaceEdge {
  std::size_t face = 0;
  std::size_t corner = 0;
};

class Boundary {
 public:
  Boundary(std::span<const Triangle> faces, const HalfEdges& edges, const JobContext& job)
      : faces_(faces), edges_(edges), job_(job), walked_(3 * faces.size(), 0) {}

  /// The edges with a single face, in order.
  [[nodiscard]] std::vector<FaceEdge> open_edges() const {
    using Found = std::vector<FaceEdge>;
    return parallel_reduce_ordered(
        faces_.size(), kGrain, Found{},
        [&](std::size_t begin, std::size_t end) {
          Found found;
          for (std::size_t i = begin; i < end && !job_.cancelled(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
              if (edges_.is_open(faces_[i][k], faces_[i][(k + 1) % 3])) {
                found.push_back({i, k});
              }
            }
          }
          return found;
        },
        [](Found& total, const Found& part) { total.insert(total.end(), part.begin(), part.end()); });
  }

  [[nodiscard]] bool is_walked(const FaceEdge& edge) const {
    return walked_[3 * edge.face + edge.corner] != 0;
  }

  [[nodiscard]] BoundaryLoop loop_from(const FaceEdge& start) {
    BoundaryLoop loop;
    const std::uint32_t first = faces_[start.face][start.corner];
    const std::uint32_t second = faces_[start.face][(start.corner + 1) % 3];
    walked_[3 * start.face + start.corner] = 1;
    loop.vertices = {first, second};
    loop.closed = walk(start, second, loop.vertices);
    if (loop.closed) {
      loop.vertices.pop_back();
    } else {
      std::vector<std::uint32_t> before;
      walk(start, first, before);
      loop.vertices.insert(loop.vertices.begin(), before.rbegin(), before.rend());
    }
    return loop;
  }

 private:
  /// Appends the vertices from a walked edge on beyond its vertex `pivot`; whether that comes back to an edge
  /// that was walked: as next_open() leads back as well as on, it can only be the first.
  bool walk(FaceEdge edge, std::uint32_t pivot, std::vector<std::uint32_t>& vertices) {
    while (const std::optional<FaceEdge> next = next_open(edge, pivot)) {
      if (is_walked(*next)) {
        return true;
      }
      edge = *next;
      walked_[3 * edge.face + edge.corner] = 1;
      const Triangle& f = faces_[edge.face];
      pivot = f[edge.corner] == pivot ? f[(edge.corner + 1) % 3] : f[edge.corner];
      vertices.push_back(pivot);
    }
    return false;
  }

  /// Around an end of an open edge, face by face, to the open edge at which its fan ends; none if it ends
  /// among more than two faces. From an edge with one face, no face is come to twice (HalfEdges::across).
  [[nodiscard]] std::optional<FaceEdge> next_open(FaceEdge edge, std::uint32_t pivot) const {
    for (;;) {
      const Triangle& f = faces_[edge.face];
      // The other edge of this face at the pivot.
      const std::size_t at = static_cast<std::size_t>(corner_of(f, pivot));
      edge.corner = edge.corner == at ? (at + 2) % 3 : at;
      const std::uint32_t a = f[edge.corner];
      const std::uint32_t b = f[(edge.corner + 1) % 3];
      const std::int64_t other = edges_.across(static_cast<std::uint32_t>(edge.face), a, b);
      if (other < 0) {
        return edges_.is_open(a, b) ? std::optional(edge) : std::nullopt;
      }
      if (job_.cancelled()) {
        return std::nullopt;
      }
      edge.face = static_cast<std::size_t>(other);
      const Triangle& g = faces_[edge.face];
      const std::size_t of_a = static_cast<std::size_t>(corner_of(g, a));
      edge.corner = g[(of_a + 1) % 3] == b ? of_a : (of_a + 2) % 3;
    }
  }

  std::span<const Triangle> faces_;
  const HalfEdges& edges_;
  const JobContext& job_;
  std::vector<std::uint8_t> walked_;  ///< by face and corner
};

}  // namespace

std::vector<BoundaryLoop> boundary_loops(std::span<const Triangle> faces, const HalfEdges& edges,
                                         const JobContext& job) {
  Boundary boundary(faces, edges, job);
  std::vector<BoundaryLoop> loops;
  for (const FaceEdge& start : boundary.open_edges()) {
    if (job.cancelled()) {
      break;
    }
    if (!boundary.is_walked(start)) {
      loops.push_back(boundary.loop_from(start));
    }
  }
  return loops;
}

}  // namespace dubsar
