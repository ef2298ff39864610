// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/next_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// Looks of less chance say nothing of a place.
constexpr double kLeastLook = 0.02;
/// What a view clears beside what it is certain to: a place counts as cleared when a third of it is, and good
/// samples clear the red ones around them. Median over simulated tablets of actual over predicted.
constexpr double kSpill = 1.15;
constexpr std::size_t kOverlapPatches = 500;

double clearance_of(const ModelSurface& surface) {
  // Shadow rays start above the thinned surface's own error.
  return std::max(0.1, 0.6 * surface.step_mm);
}

struct RedOnes {
  std::vector<std::size_t> chosen;  ///< evenly; each stands for `share` times its area
  std::vector<std::size_t> others;
};

bool is_planned_for(const RedTarget& target) {
  return target.state == RegionState::kRed && !target.given_up;
}

RedOnes thinned_red(std::span<const RedTarget> targets, std::size_t most) {
  RedOnes out;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (is_planned_for(targets[i])) {
      out.chosen.push_back(i);
    }
  }
  if (out.chosen.size() > most) {
    const std::vector<std::size_t> red = std::exchange(out.chosen, {});
    for (std::size_t k = 0, next = 0; k < red.size(); ++k) {
      const bool is_chosen = k == next * red.size() / most;
      next += is_chosen ? 1 : 0;
      (is_chosen ? out.chosen : out.others).push_back(red[k]);
    }
  }
  return out;
}

/// What all candidates together promise of targets that gains are not worked out for: they are asked in
/// `order` until one has enough chance. Returns false when cancelled.
bool ask_until_enough(std::span<const ViewPredictor> views, std::span<const std::size_t> order,
                      std::span<const RedTarget> targets, std::span<const std::size_t> asked, double enough,
                      NextViews& out, const JobContext& job) {
  parallel_for_each_index(
      asked.size(),
      [&](std::size_t k) {
        const std::size_t i = asked[k];
        const RedTarget& t = targets[i];
        double best = 0;
        double left = 0;
        for (std::size_t c = 0; c < order.size() && left < enough && !job.cancelled(); ++c) {
          const ViewPredictor& view = views[order[c]];
          const double p = view.chance(t.position_mm, t.normal);
          best = std::max(best, p);
          left = std::max(left, p > 0 ? p * novelty(t.tried, view.towards_scanner()) : 0.0);
        }
        out.best_chance[i] = static_cast<float>(best);
        out.best_left[i] = static_cast<float>(left);
      },
      16);
  return !job.cancelled();
}

double overlap_of(const ViewPredictor& view, const ModelSurface& surface) {
  double seen = 0;
  double unseen = 0;
  const auto visible = [&](const std::vector<SurfacePatch>& patches, std::size_t stride) {
    double area = 0;
    for (std::size_t i = 0; i < patches.size(); i += stride) {
      if (view.chance(patches[i].position_mm, patches[i].normal) > 0.3) {
        area += patches[i].area_mm2 * static_cast<double>(stride);
      }
    }
    return area;
  };
  seen = visible(surface.seen, surface.seen.size() / kOverlapPatches + 1);
  unseen = visible(surface.unseen, surface.unseen.size() / kOverlapPatches + 1);
  return seen > 0 ? seen / (seen + unseen) : 0.0;
}

/// As the scan was taken, with its own spacing and laser and camera where they stood; in the field that new
/// views are supposed to have.
ScannerModel scanner_of(const RangeGrid& grid, const Rig* rig, double noise_mm) {
  ScannerModel scanner = ScannerModel::of(grid, noise_mm);
  if (rig != nullptr) {
    scanner.field_mm = ScannerModel::of(*rig, noise_mm).field_mm;
  }
  return scanner;
}

/// What a further look is worth: a view that was taken for nothing is not advised again, whether or not that
/// is enough to excuse the place.
double left_of(const RedTarget& target, const Eigen::Vector3d& towards_scanner) {
  return novelty(target.tried, towards_scanner) * novelty(target.perhaps, towards_scanner);
}

}  // namespace

void note_tries(std::span<const PlacedScan> scans, const Rig* rig, std::span<const double> noise_mm,
                const ModelSurface& surface, std::vector<RedTarget>& targets) {
  std::vector<ViewPredictor> views;
  std::vector<Eigen::AlignedBox3d> fields;  // that they certainly had, scanner frame
  views.reserve(scans.size());
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const RangeGrid& grid = *scans[s].grid;
    views.emplace_back(scanner_of(grid, rig, noise_mm[s]), scans[s].model_from_scanner, surface.query,
                       clearance_of(surface));
    fields.push_back(ScannerModel::that_took(grid, rig, noise_mm[s]).field_mm);
  }
  parallel_for_each_index(
      targets.size(),
      [&](std::size_t i) {
        RedTarget& target = targets[i];
        target.tried.clear();
        target.perhaps.clear();
        for (std::size_t s = 0; s < views.size(); ++s) {
          const ViewPredictor& view = views[s];
          const double chance = view.facing_chance(target.position_mm, target.normal);
          if (chance > kLeastLook && view.unobstructed(target.position_mm, target.normal)) {
            const bool surely =
                fields[s].contains(scans[s].model_from_scanner.inverse() * target.position_mm);
            (surely ? target.tried : target.perhaps)
                .push_back({view.towards_scanner(), view.towards_camera(target.position_mm), chance});
          }
        }
      },
      16);
}

std::vector<double> clearing_chances(const ViewCandidate& candidate, const ScannerModel& scanner,
                                     const ModelSurface& surface, std::span<const RedTarget> targets) {
  const ViewPredictor view(scanner, candidate.model_from_scanner, surface.query, clearance_of(surface),
                           candidate.hidden);
  std::vector<double> chances(targets.size(), 0.0);
  parallel_for_each_index(
      targets.size(),
      [&](std::size_t i) {
        const RedTarget& t = targets[i];
        if (t.state == RegionState::kRed) {
          const double p = view.chance(t.position_mm, t.normal);
          chances[i] = std::min(1.0, kSpill * p * left_of(t, view.towards_scanner()));
        }
      },
      16);
  return chances;
}

Result<NextViews> next_views(std::span<const ViewCandidate> candidates, const ScannerModel& scanner,
                             const ModelSurface& surface, std::span<const RedTarget> targets,
                             const NextViewOptions& options, JobContext& job) {
  NextViews out;
  out.best_chance.assign(targets.size(), -1.0F);
  out.best_left.assign(targets.size(), -1.0F);
  const auto [red, others] = thinned_red(targets, options.max_targets);
  if (red.empty() || candidates.empty()) {
    return out;
  }
  double all_area = 0;
  double kept_area = 0;
  for (const RedTarget& t : targets) {
    all_area += is_planned_for(t) ? t.area_mm2 : 0.0;
  }
  for (const std::size_t i : red) {
    kept_area += targets[i].area_mm2;
  }
  const double share = kept_area > 0 ? all_area / kept_area : 1.0;

  std::vector<ViewPredictor> views;
  views.reserve(candidates.size());
  for (const ViewCandidate& candidate : candidates) {
    views.emplace_back(scanner, candidate.model_from_scanner, surface.query, clearance_of(surface),
                       candidate.hidden);
  }
  struct Chance {
    float plain = 0;
    float left = 0;  ///< looks in vain considered
  };
  std::vector<double> gain(candidates.size(), 0.0);
  std::vector<double> promised(candidates.size(), 0.0);  // by the looks that certainly were in vain
  std::vector<Chance> chance(candidates.size() * red.size());
  parallel_for_each_index(
      candidates.size(),
      [&](std::size_t c) {
        if (job.cancelled()) {
          return;
        }
        for (std::size_t k = 0; k < red.size(); ++k) {
          const RedTarget& t = targets[red[k]];
          const double p = views[c].chance(t.position_mm, t.normal);
          if (p > 0) {
            const double left = p * novelty(t.tried, views[c].towards_scanner());
            chance[c * red.size() + k] = {static_cast<float>(p), static_cast<float>(left)};
            promised[c] += share * t.area_mm2 * left;
            gain[c] += share * t.area_mm2 * p * left_of(t, views[c].towards_scanner());
          }
        }
      },
      1);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "planning was stopped");
  }
  for (std::size_t k = 0; k < red.size(); ++k) {
    Chance best;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const Chance& one = chance[c * red.size() + k];
      best = {std::max(best.plain, one.plain), std::max(best.left, one.left)};
    }
    out.best_chance[red[k]] = best.plain;
    out.best_left[red[k]] = best.left;
  }

  const auto worth = [&](std::size_t c) {
    return gain[c] / (1.0 + (candidates[c].by_hand ? options.hand_turn_cost : 0.0) +
                      (candidates[c].leans ? options.lean_cost : 0.0));
  };
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  if (!ask_until_enough(views, order, targets, others, options.enough_chance, out, job)) {
    return fail(ErrorKind::kCancelled, "planning was stopped");
  }
  const auto predicted_mm2 = [&](std::size_t c) { return std::min(all_area, kSpill * gain[c]); };
  for (const double mm2 : promised) {
    out.best_gain_mm2 = std::max(out.best_gain_mm2, std::min(all_area, kSpill * mm2));
  }
  const auto propose = [&](std::size_t c) {
    out.ranked.push_back(
        {candidates[c].model_from_scanner, predicted_mm2(c), candidates[c].say, candidates[c].placement});
  };
  // The overlap of a candidate costs as much as its gain: asked for in order of worth, a few at a time, until
  // enough are found.
  constexpr std::size_t kBatch = 24;
  std::vector<std::pair<double, std::size_t>> refused;
  for (std::size_t begin = 0; begin < order.size(); begin += kBatch) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "planning was stopped");
    }
    const std::size_t end = std::min(begin + kBatch, order.size());
    if (out.ranked.size() >= options.ranked || gain[order[begin]] < options.least_gain_mm2) {
      break;
    }
    std::vector<double> overlap(end - begin);
    parallel_for_each_index(
        end - begin, [&](std::size_t k) { overlap[k] = overlap_of(views[order[begin + k]], surface); }, 1);
    for (std::size_t k = begin; k < end && out.ranked.size() < options.ranked; ++k) {
      if (gain[order[k]] < options.least_gain_mm2) {
        break;
      }
      if (overlap[k - begin] >= options.least_overlap) {
        propose(order[k]);
      } else {
        refused.emplace_back(overlap[k - begin], order[k]);
      }
    }
  }
  if (out.ranked.empty()) {
    std::stable_sort(refused.begin(), refused.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t k = 0; k < refused.size() && k < options.ranked; ++k) {
      propose(refused[k].second);
    }
  }
  return out;
}

}  // namespace dubsar
