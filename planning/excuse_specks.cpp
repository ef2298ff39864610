// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "planning/clusters.h"
#include "planning/excuse.h"

namespace dubsar {

namespace {

constexpr double kChordHeights = 2.5;

/// Where interpolation puts the surface beside a red sample: half way to the well-sampled surface, on the
/// plane through what lies around, near samples counting more (one sample's noise is too much); and how far
/// the sample rises over its neighbour. Nothing where the well-sampled surface is out of reach.
struct Bridge {
  Eigen::Vector3d filled_mm{0, 0, 0};
  double rise_mm = 0;
};

std::optional<Bridge> bridge(const SurfaceCover& cover, const RedTarget& target) {
  const Eigen::Vector3d& sample = target.sample_mm;
  const double radius_mm = cover.reach_mm_at(sample);
  const auto around = cover.within(sample, radius_mm);
  const auto nearest = std::min_element(around.begin(), around.end(), [&](const auto& a, const auto& b) {
    return (a.position_mm.template cast<double>() - sample).squaredNorm() <
           (b.position_mm.template cast<double>() - sample).squaredNorm();
  });
  if (nearest == around.end()) {
    return std::nullopt;
  }
  const Eigen::Vector3d from = nearest->position_mm.cast<double>();
  const Eigen::Vector3d middle = 0.5 * (sample + from);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const auto& e : around) {
    normal += e.normal.cast<double>();
  }
  normal.normalize();
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Eigen::Matrix3d moments = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d heights = Eigen::Vector3d::Zero();
  const auto add = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d d = p - middle;
    const double w = std::pow(std::max(0.0, 1.0 - d.squaredNorm() / (radius_mm * radius_mm)), 2.0);
    const Eigen::Vector3d t(1.0, u.dot(d), v.dot(d));
    moments += w * t * t.transpose();
    heights += w * normal.dot(d) * t;
  };
  for (const auto& e : around) {
    add(e.position_mm.cast<double>());
  }
  add(sample);
  const Eigen::Vector3d plane = moments.ldlt().solve(heights);
  return Bridge{middle + normal * plane[0], std::abs(nearest->normal.cast<double>().dot(sample - from))};
}

void excuse_speck(const SurfaceCover& cover, std::string why, RedTarget& target) {
  target.excuse_as(Excuse::kUnneeded, std::move(why));
  if (const auto filled = bridge(cover, target)) {
    target.interpolated_mm = filled->filled_mm;
  }
}

/// Red on both rims of a gap up to this wide is one group.
constexpr double kAcrossGapsMm = 2.0;

double area_of(std::span<const std::uint32_t> group, const RedTargets& red) {
  double area_mm2 = 0;
  for (const std::uint32_t i : group) {
    area_mm2 += red.targets[i].area_mm2;
  }
  return area_mm2;
}

double largest_speck_mm2(double spacing_mm, const ExcuseOptions& options) {
  return options.speck_spacings2 * spacing_mm * spacing_mm;
}

/// Of the places of a group.
double finest_spacing_mm(std::span<const std::uint32_t> group, const SurfaceCover& cover,
                         const RedTargets& red) {
  double finest_mm = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : group) {
    finest_mm = std::min(finest_mm, cover.spacing_mm_at(red.targets[i].position_mm));
  }
  return finest_mm;
}

/// Whether a place borders clay that nobody has seen: a patch of the closing surface, or a hole larger than
/// a speck, of which it is a bit of the rim.
bool is_beside_unseen(std::span<const std::uint32_t> group, const SurfaceCover& cover, double largest_mm2,
                      const RedTargets& red) {
  const auto is_near = [&](const Eigen::Vector3d& p_mm, double within_mm) {
    return std::ranges::any_of(group, [&](std::uint32_t i) {
      const RedTarget& t = red.targets[i];
      return std::min((t.position_mm - p_mm).norm(), (t.sample_mm - p_mm).norm()) <= within_mm;
    });
  };
  return std::ranges::any_of(red.targets,
                             [&](const RedTarget& t) {
                               return t.state == RegionState::kRed && t.unseen && !t.rim &&
                                      is_near(t.position_mm, cover.reach_mm() + 0.7 * std::sqrt(t.area_mm2));
                             }) ||
         std::ranges::any_of(cover.holes(), [&](const Hole& hole) {
           // The polygon goes through samples: of a smaller one nobody can tell how large it is.
           const double reach_mm = cover.rims()[hole.rim.front()].reach_mm;
           return hole.area_mm2 > std::max(largest_mm2, reach_mm * reach_mm) &&
                  std::ranges::any_of(hole.rim, [&](std::uint32_t i) {
                    const Rim& rim = cover.rims()[i];
                    return is_near(rim.position_mm, rim.reach_mm);
                  });
         });
}

}  // namespace

void excuse_specks(std::span<const PlacedScan> scans, const SurfaceCover& cover, double surface_mm2,
                   const ExcuseOptions& options, RedTargets& red) {
  struct Speck {
    std::vector<std::uint32_t> group;
    double area_mm2 = 0;
  };
  std::vector<Speck> tried;
  std::vector<Speck> untried;
  double all_mm2 = 0;
  for (auto& group : cluster_targets(red, scans, 2.0 * red.cell_mm, kAcrossGapsMm, true)) {
    if (red.targets[group.front()].state != RegionState::kRed) {
      continue;
    }
    Eigen::AlignedBox3d box;
    std::size_t looks = full_looks_apart(red.targets[group.front()].tried);
    for (const std::uint32_t t : group) {
      box.extend(red.targets[t].position_mm);
      looks = std::min(looks, full_looks_apart(red.targets[t].tried));
    }
    const double area_mm2 = area_of(group, red);
    const double largest_mm2 = largest_speck_mm2(finest_spacing_mm(group, cover, red), options);
    all_mm2 += area_mm2;
    if (area_mm2 <= largest_mm2 && box.diagonal().norm() <= options.largest_gap_mm &&
        !is_beside_unseen(group, cover, largest_mm2, red)) {
      const bool enough = looks >= static_cast<std::size_t>(options.speck_tries);
      (enough ? tried : untried).push_back({std::move(group), area_mm2});
    }
  }
  std::ranges::stable_sort(tried, {}, &Speck::area_mm2);
  double left_mm2 = options.tried_speck_budget * surface_mm2;
  for (const Speck& speck : tried) {
    if (speck.area_mm2 > left_mm2) {
      break;
    }
    left_mm2 -= speck.area_mm2;
    all_mm2 -= speck.area_mm2;
    for (const std::uint32_t t : speck.group) {
      excuse_speck(cover, "speck: scans looked straight at it and found nothing more", red.targets[t]);
    }
  }
  if (all_mm2 > options.speck_budget * surface_mm2) {
    return;
  }
  for (const Speck& speck : untried) {
    // A chord is off the surface by a quarter of the height to which its far end rises over the near one.
    const bool flat = std::ranges::all_of(speck.group, [&](std::uint32_t t) {
      const auto gap = bridge(cover, red.targets[t]);
      return gap && gap->rise_mm <= kChordHeights * options.interpolation_mm;
    });
    for (std::size_t k = 0; flat && k < speck.group.size(); ++k) {
      excuse_speck(cover,
                   "speck: the gap is no larger than the rule of 3µ lets pass, and closes in a straight line",
                   red.targets[speck.group[k]]);
    }
  }
}

namespace {

/// Settles red targets that nothing will clear: those of large groups are unreachable, or stay red and are
/// named where they lie in the open; those of small ones are unneeded as long as all of them together, also
/// those that were given up before for another reason, stay below speck_budget, and stay red otherwise.
template <class GivenUp, class InTheOpen>
void give_up(std::span<const PlacedScan> scans, const SurfaceCover& cover, double surface_mm2,
             const ExcuseOptions& options, const std::string& why, const GivenUp& given_up,
             const InTheOpen& in_the_open, RedTargets& red) {
  std::vector<std::uint32_t> slits;
  for (const auto& group : cluster_targets(red, scans, red.cell_mm, kAcrossGapsMm, true)) {
    const bool slit = area_of(group, red) <= options.largest_slit_mm2;
    for (const std::uint32_t i : group) {
      if (red.targets[i].state != RegionState::kRed || !given_up(i)) {
        continue;
      }
      if (slit) {
        slits.push_back(i);
      } else if (in_the_open(i)) {
        red.targets[i].no_signal = true;
        red.targets[i].reason = "gives no signal, look at it: " + why;
      } else {
        red.targets[i].excuse_as(Excuse::kUnreachable, why);
      }
    }
  }
  const double all_mm2 = red.slits_mm2 + area_of(slits, red);
  if (all_mm2 > options.speck_budget * surface_mm2) {
    for (const std::uint32_t i : slits) {  // no view will be asked for: somebody has to know why
      red.targets[i].reason =
          "slit or pit of less than a wedge's size, one of more than may be passed over: " + why;
    }
    return;
  }
  red.slits_mm2 = all_mm2;
  for (const std::uint32_t i : slits) {
    excuse_speck(cover, "slit or pit of less than a wedge's size: " + why, red.targets[i]);
  }
}

}  // namespace

void excuse_out_of_reach(std::span<const PlacedScan> scans, const SurfaceCover& cover,
                         std::span<const float> best_chance, double surface_mm2, const ExcuseOptions& options,
                         RedTargets& red) {
  give_up(
      scans, cover, surface_mm2, options,
      "no pose that the rig allows has it within its field, unshaded for laser and camera, at a slope below "
      "70°",
      [&](std::uint32_t i) {
        return best_chance[i] >= 0 && static_cast<double>(best_chance[i]) < options.least_chance;
      },
      [](std::uint32_t) { return false; }, red);
}

void excuse_tried(std::span<const PlacedScan> scans, const SurfaceCover& cover, double surface_mm2,
                  const ExcuseOptions& options, RedTargets& red) {
  give_up(
      scans, cover, surface_mm2, options,
      std::to_string(options.tries) +
          " scans looked straight at it, each from elsewhere, and brought no dense samples: too dark, too "
          "shiny, too deep or no surface",
      [&](std::uint32_t i) {
        return full_looks_apart(red.targets[i].tried) >= static_cast<std::size_t>(options.tries);
      },
      [](std::uint32_t) { return true; }, red);
  for (RedTarget& t : red.targets) {
    t.given_up = t.no_signal && full_looks_apart(t.tried) >= 2 * static_cast<std::size_t>(options.tries);
  }
}

void excuse_tried_out(std::span<const PlacedScan> scans, const SurfaceCover& cover, const NextViews& views,
                      double surface_mm2, const ExcuseOptions& options, RedTargets& red) {
  give_up(
      scans, cover, surface_mm2, options,
      std::to_string(options.tries) +
          " scans and more might have sampled it and did not, and no other pose promises to",
      [&](std::uint32_t i) {
        return views.best_left[i] >= 0 && static_cast<double>(views.best_left[i]) < options.least_chance &&
               red.targets[i].tried.size() >= static_cast<std::size_t>(options.tries) &&
               looks_worth(red.targets[i].tried) >= 1.0;
      },
      [&](std::uint32_t i) { return static_cast<double>(views.best_chance[i]) > kTriedChance; }, red);
}

void excuse_last_specks(std::span<const PlacedScan> scans, const SurfaceCover& cover, double best_gain_mm2,
                        double surface_mm2, const ExcuseOptions& options, RedTargets& red) {
  double all_mm2 = 0;
  for (const RedTarget& t : red.targets) {
    all_mm2 += t.state == RegionState::kRed && !t.no_signal ? t.area_mm2 : 0.0;
  }
  if (all_mm2 > options.speck_budget * surface_mm2 ||
      best_gain_mm2 > largest_speck_mm2(cover.finest_spacing_mm(), options)) {
    return;
  }
  for (const auto& group : cluster_targets(red, scans, red.cell_mm, kAcrossGapsMm, true)) {
    // Of what gives no signal a part may be left that is small: a person has to look at it all the same.
    if (red.targets[group.front()].state != RegionState::kRed ||
        area_of(group, red) > options.largest_slit_mm2 ||
        std::ranges::any_of(group, [&](std::uint32_t i) { return red.targets[i].no_signal; })) {
      continue;
    }
    for (const std::uint32_t i : group) {
      excuse_speck(cover, "speck: no view is expected to clear as much as one such speck", red.targets[i]);
    }
  }
}

}  // namespace dubsar
