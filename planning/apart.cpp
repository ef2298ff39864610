// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/apart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "planning/clusters.h"

namespace dubsar {

namespace {

/// How deep laser and camera see into a hole, in its widths: they stand 15° apart at least.
constexpr double kDeepestInWidths = 4.0;
constexpr double kSecondBodyShare = 0.02;  ///< of the elements of the largest part

/// A hole of the cover, or a patch of red.
struct Opening {
  Eigen::AlignedBox3d box;
  double far_mm = 0;        ///< what is connected through it lies no farther
  std::uint32_t piece = 0;  ///< that it is in
};

/// Parts of the cover and red targets with samples, by what hangs together. A piece is named by its lowest
/// node: node p is part p of the cover, node parts + i is target i.
class Pieces {
 public:
  Pieces(std::span<const PlacedScan> scans, const SurfaceCover& cover, const RedTargets& red)
      : cover_(cover),
        red_(red),
        parts_(static_cast<std::uint32_t>(cover.parts().size())),
        sets_(parts_ + red.targets.size()),
        patches_(cluster_targets(red, scans, cover.reach_mm() + red.cell_mm, 0.0, false)) {
    std::erase_if(patches_, [&](const std::vector<std::uint32_t>& patch) {
      return red.targets[patch.front()].state != RegionState::kRed;
    });
    for (const auto& patch : patches_) {
      for (const std::uint32_t i : patch) {
        sets_.join(node(patch.front()), node(i));
        for (const auto& e : cover.within(red.targets[i].sample_mm, cover.reach_mm() + red.cell_mm)) {
          sets_.join(node(i), e.part);
        }
      }
    }
  }

  [[nodiscard]] std::uint32_t of_part(std::uint32_t part) { return sets_.find(part); }
  [[nodiscard]] std::uint32_t of_target(std::uint32_t target) { return sets_.find(node(target)); }
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& patches() const { return patches_; }

  [[nodiscard]] std::vector<Opening> openings() {
    std::vector<Opening> out;
    const auto add = [&](const Eigen::AlignedBox3d& box, double width_mm, std::uint32_t piece) {
      const double far_mm = kDeepestInWidths * std::max(width_mm, cover_.reach_mm()) + cover_.reach_mm();
      out.push_back({box, far_mm, piece});
    };
    for (const Hole& hole : cover_.holes()) {
      Eigen::AlignedBox3d box;
      for (const std::uint32_t i : hole.rim) {
        box.extend(cover_.rims()[i].position_mm);
      }
      add(box, hole.width_mm, of_part(cover_.rims()[hole.rim.front()].part));
    }
    for (const auto& patch : patches_) {
      Eigen::AlignedBox3d box;
      for (const std::uint32_t i : patch) {
        box.extend(red_.targets[i].sample_mm);
        box.extend(red_.targets[i].position_mm);
      }
      add(box, box.diagonal().norm(), of_target(patch.front()));
    }
    return out;
  }

  /// By piece, where the elements and samples lie of those that are not in `clay`.
  [[nodiscard]] std::vector<std::vector<Eigen::Vector3d>> points(const std::set<std::uint32_t>& clay) {
    std::vector<std::vector<Eigen::Vector3d>> out(parts_ + red_.targets.size());
    for (const auto& e : cover_.elements()) {
      if (e.part != 0 && !clay.contains(of_part(e.part))) {
        out[of_part(e.part)].push_back(e.position_mm.cast<double>());
      }
    }
    for (const auto& patch : patches_) {
      for (const std::uint32_t i : patch) {
        if (!clay.contains(of_target(i))) {
          out[of_target(i)].push_back(red_.targets[i].sample_mm);
        }
      }
    }
    return out;
  }

  /// The largest, and those that may be a second body.
  [[nodiscard]] std::set<std::uint32_t> large() {
    std::vector<std::size_t> elements(parts_, 0);
    for (std::uint32_t p = 0; p < parts_; ++p) {
      elements[of_part(p)] += cover_.parts()[p];
    }
    std::set<std::uint32_t> out;
    for (std::uint32_t p = 0; p < parts_; ++p) {
      if (p == of_part(0) ||
          static_cast<double>(elements[p]) > kSecondBodyShare * static_cast<double>(elements[of_part(0)])) {
        out.insert(p);
      }
    }
    return out;
  }

 private:
  [[nodiscard]] std::uint32_t node(std::uint32_t target) const { return parts_ + target; }

  const SurfaceCover& cover_;
  const RedTargets& red_;
  std::uint32_t parts_;
  UnionFind sets_;
  std::vector<std::vector<std::uint32_t>> patches_;  ///< of red targets
};

/// The pieces that are clay, as far as anybody can tell.
std::set<std::uint32_t> clay_of(Pieces& pieces) {
  std::set<std::uint32_t> clay = pieces.large();
  std::vector<std::vector<Eigen::Vector3d>> points = pieces.points(clay);
  const std::vector<Opening> openings = pieces.openings();
  std::vector<std::uint32_t> news(clay.begin(), clay.end());
  while (!news.empty()) {
    const std::uint32_t from = news.back();
    news.pop_back();
    for (const Opening& opening : openings) {
      if (opening.piece != from) {
        continue;
      }
      for (std::uint32_t p = 0; p < points.size(); ++p) {
        const auto near = [&](const Eigen::Vector3d& at) {
          return opening.box.exteriorDistance(at) <= opening.far_mm;
        };
        if (!points[p].empty() && std::ranges::any_of(points[p], near)) {
          clay.insert(p);
          news.push_back(p);
          points[p].clear();
        }
      }
    }
  }
  return clay;
}

}  // namespace

std::vector<std::uint8_t> excuse_apart(std::span<const PlacedScan> scans, const SurfaceCover& cover,
                                       RedTargets& red) {
  std::vector<std::uint8_t> apart(cover.holes().size(), 0);
  if (cover.parts().empty()) {
    return apart;
  }
  Pieces pieces(scans, cover, red);
  const std::set<std::uint32_t> clay = clay_of(pieces);
  for (const auto& patch : pieces.patches()) {
    for (const std::uint32_t i : patch) {
      if (!clay.contains(pieces.of_target(i))) {
        red.targets[i].excuse_as(Excuse::kUnneeded,
                                 "stray return: it hangs apart from the surface, which is closed there");
        red.targets[i].area_mm2 = 0;
      }
    }
  }
  for (std::size_t h = 0; h < apart.size(); ++h) {
    const std::uint32_t part = cover.rims()[cover.holes()[h].rim.front()].part;
    apart[h] = clay.contains(pieces.of_part(part)) ? 0 : 1;
  }
  return apart;
}

}  // namespace dubsar
