// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/crowded_vertices.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "core/parallel.h"
#include "triangulation/face_cut.h"
#include "triangulation/part_cells.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Positions = std::span<const Vector3f>;
using Face = std::array<std::uint32_t, 3>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
using Box = Eigen::AlignedBox3d;

/// Of faces at one vertex: below it, each with each is quicker.
constexpr std::size_t kLeastCrowd = 64;
/// Beyond what directions and boxes of doubles are off by.
constexpr double kRounding = 1e-9;
constexpr double kMargin = 1e-6;

Box whole_sphere() {
  return {Vector3d::Constant(-2), Vector3d::Constant(2)};
}

/// Of the shorter great arc between two directions.
Box box_of_arc(const Vector3d& a, const Vector3d& b) {
  constexpr double kNearlyOpposite = -0.99;
  constexpr double kShort = 0.05;  // chord; the sagitta is then hardly more than an eighth of its square
  Box box(a);
  box.extend(b);
  const double chord = (b - a).norm();
  if (a.dot(b) < kNearlyOpposite) {
    return whole_sphere();
  }
  if (chord < kShort) {
    const Vector3d sagitta = Vector3d::Constant(chord * chord / 7);
    return {box.min() - sagitta, box.max() + sagitta};
  }
  // Where the great circle comes nearest to an axis, if that is between the two.
  const Vector3d normal = a.cross(b).normalized();
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d top = Vector3d::Unit(axis) - normal[axis] * normal;
    const double length = top.norm();
    if (length < kRounding) {
      continue;
    }
    top /= length;
    for (const Vector3d& end : {top, Vector3d(-top)}) {
      if (normal.dot(a.cross(end)) >= -kRounding && normal.dot(end.cross(b)) >= -kRounding) {
        box.extend(end);
      }
    }
  }
  return box;
}

/// Whether a direction is, or may be but for rounding, within a spherical triangle.
bool may_be_within(const Vector3d& d, const std::array<Vector3d, 3>& t) {
  bool left = true;
  bool right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = t[k].cross(t[(k + 1) % 3]).dot(d);
    left = left && side >= -kRounding;
    right = right && side <= kRounding;
  }
  return left || right;
}

/// Of the directions in which the points of a face lie, seen from a vertex that it may have as a corner.
Box box_on_sphere(Positions positions, const Face& face, std::uint32_t from) {
  std::array<Vector3d, 3> direction;
  std::size_t corners = 0;
  for (const std::uint32_t v : face) {
    if (v == from) {
      continue;
    }
    const Vector3d d = positions[v].cast<double>() - positions[from].cast<double>();
    const double length = d.norm();
    if (!(length > 0)) {
      return whole_sphere();
    }
    direction[corners++] = d / length;
  }
  Box box;
  for (std::size_t k = 0; k < corners; ++k) {
    box.extend(box_of_arc(direction[k], direction[(k + 1) % corners]));
  }
  for (int axis = 0; axis < 3 && corners == 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Vector3d end = sign * Vector3d::Unit(axis);
      if (may_be_within(end, direction)) {
        box.extend(end);
      }
    }
  }
  return {box.min() - Vector3d::Constant(kMargin), box.max() + Vector3d::Constant(kMargin)};
}

/// Boxes in a tree, each node's halves parted where its boxes' middles spread the most. Of a job that is
/// cancelled some are missing.
class BoxTree {
 public:
  BoxTree(std::vector<std::pair<Box, std::uint32_t>> items, const JobContext& job)
      : items_(std::move(items)) {
    boxes_.resize(2 * items_.size());
    build(0, 0, items_.size(), job);
  }
  [[nodiscard]] const std::vector<std::pair<Box, std::uint32_t>>& items() const { return items_; }

  /// visit(item) for the items from `least` on whose boxes touch the given one. Returns how many boxes it was
  /// held against.
  template <class Visit>
  std::size_t for_each_touching(const Box& box, std::size_t least, const Visit& visit) const {
    return search(0, 0, items_.size(), box, least, visit);
  }

 private:
  static constexpr std::size_t kLeaf = 4;

  /// A node's left half is the node after it; the right one comes after all of the left, which has fewer
  /// nodes than twice its items.
  static std::size_t right_of(std::size_t node, std::size_t left_items) { return node + 2 * left_items; }

  void build(std::size_t node, std::size_t begin, std::size_t end, const JobContext& job) {
    if (job.cancelled()) {
      return;
    }
    Box box;
    Box middles;
    for (std::size_t k = begin; k < end; ++k) {
      box.extend(items_[k].first);
      middles.extend(items_[k].first.center());
    }
    if (begin == end) {
      return;
    }
    boxes_[node] = box;
    if (end - begin <= kLeaf) {
      return;
    }
    Eigen::Index axis = 0;
    middles.sizes().maxCoeff(&axis);
    const std::size_t half = begin + (end - begin) / 2;
    const auto at = [&](std::size_t k) { return items_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(begin), at(half), at(end), [axis](const auto& a, const auto& b) {
      return std::pair(a.first.center()[axis], a.second) < std::pair(b.first.center()[axis], b.second);
    });
    build(node + 1, begin, half, job);
    build(right_of(node, half - begin), half, end, job);
  }

  template <class Visit>
  std::size_t search(std::size_t node, std::size_t begin, std::size_t end, const Box& box, std::size_t least,
                     const Visit& visit) const {
    if (end <= least || begin == end) {
      return 0;
    }
    if (!box.intersects(boxes_[node])) {
      return 1;
    }
    if (end - begin <= kLeaf) {
      for (std::size_t k = std::max(begin, least); k < end; ++k) {
        if (box.intersects(items_[k].first)) {
          visit(items_[k].second);
        }
      }
      return 1 + end - std::max(begin, least);
    }
    const std::size_t half = begin + (end - begin) / 2;
    return 1 + search(node + 1, begin, half, box, least, visit) +
           search(right_of(node, half - begin), half, end, box, least, visit);
  }

  std::vector<std::pair<Box, std::uint32_t>> items_;
  std::vector<Box> boxes_;  ///< by node
};

Pairs joined(std::size_t count, const auto& map) {
  return parallel_reduce_ordered(count, 256, Pairs{}, map, [](Pairs& total, const Pairs& part) {
    total.insert(total.end(), part.begin(), part.end());
  });
}

/// The faces at a vertex: first those at none of the edges there where at least so many meet, then those of
/// each such edge. A face is in one only. Faces that share an edge cannot cut each other.
std::vector<std::vector<std::uint32_t>> parted_by_edges(std::span<const Face> faces, std::uint32_t vertex,
                                                        const std::vector<std::uint32_t>& crowd,
                                                        std::size_t least) {
  std::vector<std::uint32_t> ends;
  for (const std::uint32_t face : crowd) {
    std::ranges::copy_if(faces[face], std::back_inserter(ends), [&](std::uint32_t v) { return v != vertex; });
  }
  std::ranges::sort(ends);
  std::vector<std::uint32_t> crowded;
  for (std::size_t k = 0; k + least <= ends.size(); ++k) {
    if (ends[k] == ends[k + least - 1] && (crowded.empty() || crowded.back() != ends[k])) {
      crowded.push_back(ends[k]);
    }
  }
  std::vector<std::vector<std::uint32_t>> out(1 + crowded.size());
  for (const std::uint32_t face : crowd) {
    std::size_t part = 0;
    for (const std::uint32_t v : faces[face]) {
      const auto found = std::ranges::lower_bound(crowded, v);
      if (part == 0 && found != crowded.end() && *found == v) {
        part = 1 + static_cast<std::size_t>(found - crowded.begin());
      }
    }
    out[part].push_back(face);
  }
  return out;
}

/// Those in which one face is of the crowd at a vertex, and the other too, or of the rest.
Pairs cuts_of_crowd(Positions positions, std::span<const Face> faces, std::uint32_t vertex,
                    const std::vector<std::vector<std::uint32_t>>& crowd,
                    const std::vector<std::uint32_t>& rest, const JobContext& job, const CountWork& counted) {
  Eigen::AlignedBox3f reach;
  std::vector<BoxTree> trees;
  for (const std::vector<std::uint32_t>& part : crowd) {
    for (const std::uint32_t face : part) {
      reach.extend(box_of(positions, faces[face]));
    }
    std::vector<std::pair<Box, std::uint32_t>> arcs(part.size());
    parallel_for_each_index(part.size(), [&](std::size_t k) {
      arcs[k] = {box_on_sphere(positions, faces[part[k]], vertex), part[k]};
    });
    trees.emplace_back(std::move(arcs), job);
  }
  const auto find = [&](const BoxTree& tree, std::uint32_t face, const Box& box, std::size_t least,
                        Pairs& found) {
    const FacePlane plane(positions, faces[face]);
    count_work(counted, tree.for_each_touching(box, least, [&](std::uint32_t other) {
      if (faces_cut(positions, faces[face], plane, faces[other])) {
        found.push_back(std::minmax(face, other));
      }
    }));
  };
  Pairs out;
  for (std::size_t part = 0; part < trees.size(); ++part) {
    const auto& items = trees[part].items();
    const Pairs found_here = joined(items.size(), [&](std::size_t begin, std::size_t end) {
      Pairs found;
      for (std::size_t k = begin; k < end && !job.cancelled(); ++k) {
        if (part == 0) {
          find(trees[0], items[k].second, items[k].first, k + 1, found);
        }
        for (std::size_t before = 0; before < part; ++before) {
          find(trees[before], items[k].second, items[k].first, 0, found);
        }
      }
      return found;
    });
    out.insert(out.end(), found_here.begin(), found_here.end());
  }
  const Pairs with_rest = joined(rest.size(), [&](std::size_t begin, std::size_t end) {
    Pairs found;
    for (std::size_t k = begin; k < end && !job.cancelled(); ++k) {
      if (box_of(positions, faces[rest[k]]).intersects(reach)) {
        const Box box = box_on_sphere(positions, faces[rest[k]], vertex);
        for (const BoxTree& tree : trees) {
          find(tree, rest[k], box, 0, found);
        }
      }
    }
    return found;
  });
  out.insert(out.end(), with_rest.begin(), with_rest.end());
  return out;
}

}  // namespace

Pairs take_cuts_at_crowded_vertices(Positions positions, std::span<const Face> faces,
                                    std::vector<std::uint32_t>& which, const JobContext& job,
                                    const CountWork& counted) {
  std::vector<std::uint32_t> at_vertex(positions.size(), 0);
  for (std::size_t k = 0; k < which.size() && !job.cancelled(); ++k) {
    for (const std::uint32_t v : faces[which[k]]) {
      ++at_vertex[v];
    }
  }
  // All faces are looked at once for each such vertex: no more than each of its own with each other costs.
  const std::size_t least =
      std::max(kLeastCrowd, static_cast<std::size_t>(std::sqrt(static_cast<double>(which.size()) / 2)));
  Pairs out;
  for (std::uint32_t vertex = 0; vertex < at_vertex.size() && !job.cancelled(); ++vertex) {
    if (at_vertex[vertex] < least) {
      continue;
    }
    const auto is_at_vertex = [&](std::uint32_t face) {
      return std::ranges::find(faces[face], vertex) != faces[face].end();
    };
    const auto rest_ends = std::stable_partition(which.begin(), which.end(),
                                                 [&](std::uint32_t face) { return !is_at_vertex(face); });
    const std::vector<std::uint32_t> crowd(rest_ends, which.end());
    which.erase(rest_ends, which.end());
    for (const std::uint32_t face : crowd) {
      for (const std::uint32_t v : faces[face]) {
        --at_vertex[v];
      }
    }
    const Pairs found = cuts_of_crowd(positions, faces, vertex, parted_by_edges(faces, vertex, crowd, least),
                                      which, job, counted);
    out.insert(out.end(), found.begin(), found.end());
  }
  return out;
}

}  // namespace dubsar
