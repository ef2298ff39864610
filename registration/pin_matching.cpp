// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_matching.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/units.h"
#include "registration/absolute_orientation.h"

namespace dubsar {

namespace {

using Pairs = std::vector<std::pair<int, int>>;

/// Pin sets beyond this are false detections for the most part; the first ones are looked at.
constexpr std::size_t kMostTips = 24;

std::optional<RigidTransform> solve(const std::vector<SeenPin>& source, const std::vector<SeenPin>& target,
                                    const Pairs& pairs) {
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  for (const auto& [s, t] : pairs) {
    from.push_back(source[static_cast<std::size_t>(s)].position_mm);
    to.push_back(target[static_cast<std::size_t>(t)].position_mm);
  }
  return absolute_orientation(from, to);
}

double off_mm(const std::vector<SeenPin>& source, const std::vector<SeenPin>& target,
              const RigidTransform& pose, const std::pair<int, int>& pair) {
  return (pose * source[static_cast<std::size_t>(pair.first)].position_mm -
          target[static_cast<std::size_t>(pair.second)].position_mm)
      .norm();
}

/// The candidate pairs that the pose brings together, each tip once, nearest first.
Pairs inliers(const std::vector<SeenPin>& source, const std::vector<SeenPin>& target,
              const RigidTransform& pose, const Pairs& candidates, double most_mm) {
  std::vector<std::pair<double, std::pair<int, int>>> near;
  for (const auto& pair : candidates) {
    const double d = off_mm(source, target, pose, pair);
    if (d <= most_mm) {
      near.emplace_back(d, pair);
    }
  }
  std::sort(near.begin(), near.end());
  std::set<int> used_source;
  std::set<int> used_target;
  Pairs out;
  for (const auto& [d, pair] : near) {
    if (!used_source.contains(pair.first) && !used_target.contains(pair.second)) {
      used_source.insert(pair.first);
      used_target.insert(pair.second);
      out.push_back(pair);
    }
  }
  return out;
}

struct Hypothesis {
  RigidTransform pose;
  Pairs pairs;
  double sum2 = 0;
};

/// Every triple of candidate pairs whose mutual distances agree gives a pose; the one that most pairs agree
/// with wins. Nothing when a different pose has as many.
std::optional<Hypothesis> best_consensus(const std::vector<SeenPin>& source,
                                         const std::vector<SeenPin>& target, const Pairs& candidates,
                                         const PinMatchOptions& options, bool must_be_unique) {
  const double off = options.sigma_mm * std::sqrt(2.0);
  const double most_mm = options.outlier_sigmas * off;
  const double distance_mm = options.distance_sigmas * 2.0 * options.sigma_mm;
  const auto compatible = [&](const std::pair<int, int>& a, const std::pair<int, int>& b) {
    if (a.first == b.first || a.second == b.second) {
      return false;
    }
    const auto position = [](const std::vector<SeenPin>& tips, int k) {
      return tips[static_cast<std::size_t>(k)].position_mm;
    };
    const double in_source = (position(source, a.first) - position(source, b.first)).norm();
    const double in_target = (position(target, a.second) - position(target, b.second)).norm();
    return std::abs(in_source - in_target) <= distance_mm;
  };
  std::optional<Hypothesis> best;
  std::size_t second = 0;
  const double turn_rad = rad_from_deg(15.0);
  const auto consider = [&](const RigidTransform& start) {
    Hypothesis h;
    h.pose = start;
    h.pairs = inliers(source, target, start, candidates, most_mm);
    for (int round = 0; round < 3 && h.pairs.size() >= 3; ++round) {
      const std::optional<RigidTransform> better = solve(source, target, h.pairs);
      if (!better) {
        break;
      }
      h.pose = *better;
      Pairs again = inliers(source, target, h.pose, candidates, most_mm);
      const bool same = again == h.pairs;
      h.pairs = std::move(again);
      if (same) {
        break;
      }
    }
    for (const auto& pair : h.pairs) {
      h.sum2 += std::pow(off_mm(source, target, h.pose, pair), 2.0);
    }
    if (!best) {
      best = std::move(h);
      return;
    }
    const bool other =
        RigidTransform{h.pose.rotation * best->pose.rotation.transpose(), {0, 0, 0}}.angle_rad() > turn_rad;
    const bool wins =
        h.pairs.size() > best->pairs.size() || (h.pairs.size() == best->pairs.size() && h.sum2 < best->sum2);
    if (other) {
      second = std::max(second, wins ? best->pairs.size() : h.pairs.size());
    }
    if (wins) {
      best = std::move(h);
    }
  };
  for (std::size_t a = 0; a < candidates.size(); ++a) {
    for (std::size_t b = a + 1; b < candidates.size(); ++b) {
      if (!compatible(candidates[a], candidates[b])) {
        continue;
      }
      for (std::size_t c = b + 1; c < candidates.size(); ++c) {
        if (compatible(candidates[a], candidates[c]) && compatible(candidates[b], candidates[c])) {
          if (const auto pose = solve(source, target, {candidates[a], candidates[b], candidates[c]})) {
            consider(*pose);
          }
        }
      }
    }
  }
  if (best && must_be_unique && second >= best->pairs.size()) {
    return std::nullopt;
  }
  return best;
}

}  // namespace

std::optional<PinMatch> match_pins(const std::vector<SeenPin>& all_source,
                                   const std::vector<SeenPin>& all_target, const PinMatchOptions& options) {
  const auto first = [](const std::vector<SeenPin>& tips) {
    return std::vector<SeenPin>(tips.begin(),
                                tips.begin() + static_cast<std::ptrdiff_t>(std::min(tips.size(), kMostTips)));
  };
  const std::vector<SeenPin> source = first(all_source);
  const std::vector<SeenPin> target = first(all_target);
  Pairs by_label;
  Pairs all;
  for (std::size_t s = 0; s < source.size(); ++s) {
    for (std::size_t t = 0; t < target.size(); ++t) {
      const std::pair<int, int> pair{static_cast<int>(s), static_cast<int>(t)};
      if (source[s].label >= 0 && source[s].label == target[t].label) {
        by_label.push_back(pair);
      }
      if (source[s].label < 0 || target[t].label < 0 || source[s].label == target[t].label) {
        all.push_back(pair);
      }
    }
  }
  const auto finished = [&](const std::optional<Hypothesis>& h, int least) -> std::optional<PinMatch> {
    if (!h || static_cast<int>(h->pairs.size()) < least) {
      return std::nullopt;
    }
    return PinMatch{h->pose, h->pairs, std::sqrt(h->sum2 / static_cast<double>(h->pairs.size()))};
  };
  if (by_label.size() >= static_cast<std::size_t>(options.least_labelled)) {
    if (const auto match =
            finished(best_consensus(source, target, by_label, options, false), options.least_labelled)) {
      return match;
    }
  }
  return finished(best_consensus(source, target, all, options, true), options.least_unlabelled);
}

}  // namespace dubsar
