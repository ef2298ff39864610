// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/apart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "planning/clusters.h"

namespace dubsar {

namespace {

/// How deep laser and camera see into a hole, in its widths: they stand 15° apart at least.
constexpr double kDeepestInWidths = 4.0;
constexpr double kSecondBodyShare = 0.02;  ///< of the elements of the largest part
/// What was seen of a piece, at the least, that somebody may want to know of: a chip of 4 x 4 mm. Less is
/// left of pins.
constexpr double kChipMm2 = 8.0;

/// A hole of the cover, or a patch of red.
struct Opening {
  Eigen::AlignedBox3d box;
  double far_mm = 0;        ///< what is connected through it lies no farther
  std::uint32_t piece = 0;  ///< that it is in
};

/// A piece that nothing has shown to be clay yet.
struct Loose {
  std::uint32_t piece = 0;
  Eigen::AlignedBox3d box;
  std::vector<Eigen::Vector3d> points_mm;

  [[nodiscard]] bool is_near(const Opening& opening) const {
    return opening.box.exteriorDistance(box) <= opening.far_mm &&
           std::ranges::any_of(points_mm, [&](const Eigen::Vector3d& at) {
             return opening.box.exteriorDistance(at) <= opening.far_mm;
           });
  }
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
        patches_(cluster_targets(red, scans, 0.0, 0.0, false, cover.reach_mm() + red.cell_mm)) {
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

  /// Where the elements and samples lie of the pieces that are not in `clay`.
  [[nodiscard]] std::vector<Loose> loose(const std::set<std::uint32_t>& clay) {
    std::map<std::uint32_t, Loose> out;
    const auto add = [&](std::uint32_t piece, const Eigen::Vector3d& at) {
      Loose& one = out[piece];
      one.piece = piece;
      one.box.extend(at);
      one.points_mm.push_back(at);
    };
    for (const auto& e : cover_.elements()) {
      if (e.part != 0 && !clay.contains(of_part(e.part))) {
        add(of_part(e.part), e.position_mm.cast<double>());
      }
    }
    for (const auto& patch : patches_) {
      for (const std::uint32_t i : patch) {
        if (!clay.contains(of_target(i))) {
          add(of_target(i), red_.targets[i].sample_mm);
        }
      }
    }
    std::vector<Loose> pieces;
    for (auto& [piece, one] : out) {
      pieces.push_back(std::move(one));
    }
    return pieces;
  }

  /// How much well-sampled surface each piece has, at the least, that is not in `clay`: elements are a cell
  /// apart or more.
  [[nodiscard]] std::map<std::uint32_t, double> seen_mm2(const std::set<std::uint32_t>& clay) {
    std::map<std::uint32_t, double> out;
    for (const auto& e : cover_.elements()) {
      if (e.part != 0 && !clay.contains(of_part(e.part))) {
        const double cell_mm = cover_.cell_mm_at(e.position_mm.cast<double>());
        out[of_part(e.part)] += cell_mm * cell_mm;
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
  std::vector<Loose> loose = pieces.loose(clay);
  std::multimap<std::uint32_t, Opening> openings;
  for (const Opening& opening : pieces.openings()) {
    openings.emplace(opening.piece, opening);
  }
  std::vector<std::uint32_t> news(clay.begin(), clay.end());
  while (!news.empty() && !loose.empty()) {
    const auto [begin, end] = openings.equal_range(news.back());
    news.pop_back();
    std::erase_if(loose, [&](const Loose& one) {
      if (std::none_of(begin, end, [&](const auto& opening) { return one.is_near(opening.second); })) {
        return false;
      }
      clay.insert(one.piece);
      news.push_back(one.piece);
      return true;
    });
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
  const std::map<std::uint32_t, double> seen_mm2 = pieces.seen_mm2(clay);
  for (const auto& patch : pieces.patches()) {
    for (const std::uint32_t i : patch) {
      const std::uint32_t piece = pieces.of_target(i);
      if (clay.contains(piece)) {
        continue;
      }
      const auto seen = seen_mm2.find(piece);
      if (seen == seen_mm2.end() || seen->second < kChipMm2) {
        red.targets[i].excuse_as_stray();
      } else {
        red.targets[i].excuse_as(Excuse::kUnneeded,
                                 "it hangs apart from the surface, which is closed there: at least " +
                                     std::to_string(std::lround(seen->second)) +
                                     " mm2 of it were seen; a chip is scanned by itself");
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
