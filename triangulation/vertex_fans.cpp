// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/vertex_fans.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/disjoint_sets.h"

namespace dubsar {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The faces around a vertex by the vertex at their one side, for a crowd of them: each search passes over
/// those that have their fan only once.
class SideIndex {
 public:
  template <class Side>
  SideIndex(std::size_t count, const Side& side) : passed_(count, 0) {
    faces_.reserve(count);
    for (std::size_t o = 0; o < count; ++o) {
      faces_.emplace_back(side(o), static_cast<std::uint32_t>(o));
    }
    std::ranges::sort(faces_);
  }
  /// The first face with this vertex at its side that has no fan yet, or `otherwise`.
  [[nodiscard]] std::size_t first(std::uint32_t vertex, const std::vector<std::uint32_t>& fan,
                                  std::size_t otherwise) {
    const auto start = static_cast<std::size_t>(
        std::ranges::lower_bound(faces_, std::pair(vertex, std::uint32_t{0})) - faces_.begin());
    if (start == faces_.size()) {
      return otherwise;
    }
    for (std::size_t at = start + passed_[start]; at < faces_.size() && faces_[at].first == vertex; ++at) {
      if (fan[faces_[at].second] == kNone) {
        return faces_[at].second;
      }
      ++passed_[start];
    }
    return otherwise;
  }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> faces_;  ///< vertex, number of the face
  std::vector<std::uint32_t> passed_;  ///< where the faces of a vertex begin: how many of them have a fan
};

/// beside(face, forward): the face beside that one that has no fan yet, or how many faces there are.
template <class Beside>
std::uint32_t number_by(const Beside& beside, std::vector<std::uint32_t>& fan) {
  std::uint32_t fans = 0;
  for (std::size_t first = 0; first < fan.size(); ++first) {
    if (fan[first] != kNone) {
      continue;
    }
    // Both ways round from this face; forward alone takes in the whole of a closed fan.
    for (const bool forward : {true, false}) {
      for (std::size_t o = first; o != fan.size(); o = beside(o, forward)) {
        fan[o] = fans;
      }
    }
    ++fans;
  }
  return fans;
}

}  // namespace

std::uint32_t number_fans(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v,
                          std::vector<std::uint32_t>& fan) {
  const std::span<const HalfEdges::Out> outs = edges.from(v);
  fan.assign(outs.size(), kNone);
  const auto to = [&](std::size_t o) { return outs[o].to; };
  const auto from = [&](std::size_t o) {  // where the half-edge that comes to v in the same face starts
    const Triangle& f = faces[outs[o].face];
    return f[static_cast<std::size_t>((corner_of(f, v) + 2) % 3)];
  };
  if (outs.size() > HalfEdges::kFew) {
    SideIndex by_to(outs.size(), to);
    SideIndex by_from(outs.size(), from);
    return number_by(
        [&](std::size_t o, bool forward) {
          return forward ? by_to.first(from(o), fan, outs.size()) : by_from.first(to(o), fan, outs.size());
        },
        fan);
  }
  return number_by(
      [&](std::size_t o, bool forward) {
        for (std::size_t other = 0; other < outs.size(); ++other) {
          if (fan[other] == kNone && (forward ? to(other) == from(o) : from(other) == to(o))) {
            return other;
          }
        }
        return outs.size();
      },
      fan);
}

bool is_one_fan(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v) {
  const std::span<const HalfEdges::Out> outs = edges.from(v);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;  // vertex, number of the face
  sides.reserve(2 * outs.size());
  for (std::uint32_t o = 0; o < outs.size(); ++o) {
    for (const std::uint32_t side : faces[outs[o].face]) {
      if (side != v) {
        sides.emplace_back(side, o);
      }
    }
  }
  std::ranges::sort(sides);
  DisjointSets sets(outs.size());
  for (std::size_t k = 1; k < sides.size(); ++k) {
    if (sides[k].first == sides[k - 1].first) {
      sets.unite(sides[k].second, sides[k - 1].second);
    }
  }
  for (std::uint32_t o = 0; o < outs.size(); ++o) {
    if (sets.root(o) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace dubsar
