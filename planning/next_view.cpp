// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/next_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// A scan that predicts this chance ought to have seen the place.
constexpr double kTriedChance = 0.5;
/// Views closer than this see the same shadows.
const double kSameSideRad = rad_from_deg(25.0);
/// What is left of a target's worth after one look in vain from the same side, and from any side.
constexpr double kLeftSameSide = 0.15;
constexpr double kLeftAnySide = 0.8;
/// What a view clears beside what it is certain to: a place counts as cleared when a third of it is, and good
/// samples clear the red ones around them. Median over simulated tablets of actual over predicted.
constexpr double kSpill = 1.15;
constexpr std::size_t kOverlapPatches = 500;

double clearance_of(const ModelSurface& surface) {
  // Shadow rays start above the thinned surface's own error.
  return std::max(0.1, 0.6 * surface.step_mm);
}

/// What earlier looks in vain leave of the chance from this side.
double novelty(const RedTarget& target, const Eigen::Vector3d& towards) {
  double left = 1.0;
  for (const Eigen::Vector3d& tried : target.tried) {
    const double apart = std::acos(std::clamp(tried.dot(towards), -1.0, 1.0)) / kSameSideRad;
    left *= kLeftAnySide * (1.0 - (1.0 - kLeftSameSide) * std::exp(-apart * apart));
  }
  return left;
}

/// Evenly chosen red targets; each stands for `share` times its area.
std::vector<std::size_t> thinned_red(std::span<const RedTarget> targets, std::size_t most) {
  std::vector<std::size_t> red;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i].state == RegionState::kRed) {
      red.push_back(i);
    }
  }
  if (red.size() <= most) {
    return red;
  }
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < most; ++k) {
    out.push_back(red[k * red.size() / most]);
  }
  return out;
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

}  // namespace

void note_tries(std::span<const PlacedScan> scans, const Rig* rig, std::span<const double> noise_mm,
                const ModelSurface& surface, std::vector<RedTarget>& targets) {
  std::vector<ViewPredictor> views;
  views.reserve(scans.size());
  for (std::size_t s = 0; s < scans.size(); ++s) {
    views.emplace_back(ScannerModel::that_took(*scans[s].grid, rig, noise_mm[s]), scans[s].model_from_scanner,
                       surface.query, clearance_of(surface));
  }
  parallel_for_each_index(
      targets.size(),
      [&](std::size_t i) {
        targets[i].tried.clear();
        for (const ViewPredictor& view : views) {
          if (view.facing_chance(targets[i].position_mm, targets[i].normal) > kTriedChance &&
              view.unobstructed(targets[i].position_mm, targets[i].normal)) {
            targets[i].tried.push_back(view.towards_scanner());
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
          chances[i] = std::min(1.0, kSpill * p * novelty(t, view.towards_scanner()));
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
  const std::vector<std::size_t> red = thinned_red(targets, options.max_targets);
  if (red.empty() || candidates.empty()) {
    return out;
  }
  double all_area = 0;
  double kept_area = 0;
  for (const RedTarget& t : targets) {
    all_area += t.state == RegionState::kRed ? t.area_mm2 : 0.0;
  }
  for (const std::size_t i : red) {
    kept_area += targets[i].area_mm2;
  }
  const double share = kept_area > 0 ? all_area / kept_area : 1.0;

  std::vector<double> gain(candidates.size(), 0.0);
  std::vector<float> chance(candidates.size() * red.size(), 0.0F);
  parallel_for_each_index(
      candidates.size(),
      [&](std::size_t c) {
        if (job.cancelled()) {
          return;
        }
        const ViewPredictor view(scanner, candidates[c].model_from_scanner, surface.query,
                                 clearance_of(surface), candidates[c].hidden);
        for (std::size_t k = 0; k < red.size(); ++k) {
          const RedTarget& t = targets[red[k]];
          const double p = view.chance(t.position_mm, t.normal);
          if (p > 0) {
            chance[c * red.size() + k] = static_cast<float>(p);
            gain[c] += share * t.area_mm2 * p * novelty(t, view.towards_scanner());
          }
        }
      },
      1);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "planning was stopped");
  }
  for (std::size_t k = 0; k < red.size(); ++k) {
    float best = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      best = std::max(best, chance[c * red.size() + k]);
    }
    out.best_chance[red[k]] = best;
  }

  const auto worth = [&](std::size_t c) {
    return gain[c] / (candidates[c].by_hand ? 1.0 + options.hand_turn_cost : 1.0);
  };
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  const auto predicted_mm2 = [&](std::size_t c) { return std::min(all_area, kSpill * gain[c]); };
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    out.best_gain_mm2 = std::max(out.best_gain_mm2, predicted_mm2(c));
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
    if (!out.ranked.empty() || gain[order[begin]] < options.least_gain_mm2) {
      break;
    }
    std::vector<double> overlap(end - begin);
    parallel_for_each_index(
        end - begin,
        [&](std::size_t k) {
          const ViewCandidate& candidate = candidates[order[begin + k]];
          overlap[k] = overlap_of(ViewPredictor(scanner, candidate.model_from_scanner, surface.query,
                                                clearance_of(surface), candidate.hidden),
                                  surface);
        },
        1);
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
