// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_judge.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/order_statistics.h"
#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// With fewer good candidates than this, the others say nothing.
constexpr std::size_t kFewest = 10;
constexpr double kGoodOdds = 1.0;
constexpr double kCompanyWidths = 4.0;

double& value(EvidenceValues& values, Evidence what) {
  return values[static_cast<std::size_t>(what)];
}

double width_mm(const WedgeCandidate& c) {
  return std::sqrt(std::max(c.area_mm2, 1e-6));
}

std::array<double, 3> sorted(std::array<double, 3> values) {
  std::ranges::sort(values);
  return values;
}

/// What the candidate shows by itself.
void look_at(WedgeCandidate* c) {
  const Wedge& w = c->wedge;
  EvidenceValues& e = c->evidence;
  const double depth = std::max(w.depth_mm, 1e-3);
  value(e, Evidence::kLeastCoverage) = sorted(c->coverage)[0];
  value(e, Evidence::kCoverage) = w.intact;
  value(e, Evidence::kExplained) = std::min(1.0, c->explained);
  value(e, Evidence::kRoughness) = std::min(1.0, 5.0 * c->rms_mm / depth);
  value(e, Evidence::kVertices) = std::clamp(std::log2(std::max(1.0, w.vertex_count / 16.0)) / 5.0, 0.0, 1.0);
  value(e, Evidence::kWidestOpening) = sorted(w.opening_angles_rad)[2] / kPi;
  value(e, Evidence::kLevelRim) = c->level_rim;
  value(e, Evidence::kWidestFace) = sorted(w.face_angles_rad)[2] / kPi;
  value(e, Evidence::kSecondSlope) = sorted(w.edge_slopes_rad)[1] / (0.5 * kPi);
}

/// Logistic regression over candidates of simulated tablets of two makes, clean, worn, broken, and scanned
/// and stitched, from 0.05 to 0.1 mm (dubsar-wedges --evidence); weights that came out against the sense of
/// what they weigh are zero.
struct Odds {
  double bias;
  EvidenceValues weight;
  [[nodiscard]] double of(const EvidenceValues& evidence) const {
    double sum = bias;
    for (std::size_t k = 0; k < evidence.size(); ++k) {
      sum += weight[k] * evidence[k];
    }
    return sum;
  }
};
/// By itself, and with the tablet's other wedges beside it.
constexpr Odds kAlone = {5.61, {1.93, 2.93, 2.36, -7.00, 0.60, -6.54, 2.23, -8.54, 5.61, 0, 0, 0, 0, 0}};
constexpr Odds kAmongOthers = {
    4.81, {3.75, 2.05, 0.85, -1.44, 0, -1.84, 0, -6.14, 2.57, -1.21, -0.59, -6.12, 0, 3.03}};

/// What the tablet's good candidates say of this one. `good`: by falling log odds.
void compare(const std::vector<const WedgeCandidate*>& good, double typical_depth, double typical_width,
             WedgeCandidate* c) {
  EvidenceValues& e = c->evidence;
  const Wedge& w = c->wedge;
  value(e, Evidence::kDepthUnlike) =
      std::min(1.0, std::abs(std::log2(std::max(w.depth_mm, 1e-3) / typical_depth)) / 2.0);
  value(e, Evidence::kWidthUnlike) = std::min(1.0, std::abs(std::log2(width_mm(*c) / typical_width)) / 2.0);
  const std::array<double, 3> openings = sorted(w.opening_angles_rad);
  const std::array<double, 3> slopes = sorted(w.edge_slopes_rad);
  std::vector<double> unlike;
  double nearest = 1e9;
  for (const WedgeCandidate* other : good) {
    if (other == c) {
      continue;
    }
    const std::array<double, 3> theirs = sorted(other->wedge.opening_angles_rad);
    const std::array<double, 3> their_slopes = sorted(other->wedge.edge_slopes_rad);
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      off += 0.7 * std::abs(openings[k] - theirs[k]) + std::abs(slopes[k] - their_slopes[k]);
    }
    const double size = std::abs(std::log2(width_mm(*c) / width_mm(*other)));
    unlike.push_back(off / 3.0 / rad_from_deg(40) + 0.5 * size);
    nearest = std::min(nearest, (other->wedge.depth_point_mm - w.depth_point_mm).norm());
  }
  const std::size_t few = std::min<std::size_t>(5, unlike.size() - 1);
  value(e, Evidence::kLonely) = std::min(1.0, value_at_rank(unlike, few));
  value(e, Evidence::kFar) = std::clamp(nearest / typical_width / 6.0, 0.0, 1.0);
}

/// How much of the hollows around each candidate, by area, belongs to good ones: on a broken face most of
/// what looks like a pit closes to none.
void note_company(const std::vector<WedgeCandidate>& candidates, const std::vector<std::uint8_t>& is_good,
                  double typical_width, double most_round, std::vector<WedgeCandidate*>* open) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto x_of = [&](std::size_t i) { return candidates[i].wedge.depth_point_mm.x(); };
  std::ranges::stable_sort(order, {}, x_of);
  const double reach = kCompanyWidths * typical_width;
  parallel_for_each_index(
      open->size(),
      [&](std::size_t k) {
        WedgeCandidate& c = *(*open)[k];
        const Eigen::Vector3d& at = c.wedge.depth_point_mm;
        double good = 0;
        double all = 0;
        for (auto it = std::ranges::lower_bound(order, at.x() - reach, {}, x_of);
             it != order.end() && x_of(*it) <= at.x() + reach; ++it) {
          const WedgeCandidate& other = candidates[*it];
          // A round one is no broken clay either: somebody's finger or a sign for a number.
          if (&other == &c || other.wedge.roundness > most_round ||
              (other.wedge.depth_point_mm - at).squaredNorm() > reach * reach) {
            continue;
          }
          good += is_good[*it] != 0 ? other.hollow_mm2 : 0.0;
          all += other.hollow_mm2;
        }
        // Alone, it is in neither good company nor bad.
        const double own = typical_width * typical_width;
        value(c.evidence, Evidence::kCompany) = (good + 0.5 * own) / (all + own);
      },
      16);
}

std::string out_of_bounds(const JudgeOptions& options, const WedgeCandidate& c) {
  const Wedge& w = c.wedge;
  if (w.depth_mm < options.min_depth_mm || w.depth_mm > options.max_depth_mm) {
    return w.depth_mm < options.min_depth_mm ? "too shallow" : "too deep";
  }
  if (w.vertex_count < options.least_vertices) {
    return "too few vertices lie on its faces";
  }
  if (w.roundness > options.most_round) {
    return "it is round: a bowl or a cone, not three faces";
  }
  if (w.depth_mm > options.most_floors * c.floor_mm) {
    return "its faces meet far below its floor";
  }
  // Whatever definition of the exit points the user wants to read: what is a wedge does not hang on it.
  std::array<double, 3> length{};
  for (std::size_t k = 0; k < 3; ++k) {
    length[k] = (w.exit_points_surface_mm[k] - w.depth_point_mm).norm();
  }
  const auto [shortest, longest] = std::ranges::minmax(length);
  if (shortest < options.min_edge_mm || longest > options.max_edge_mm) {
    return "an inner edge is too short or too long";
  }
  return {};
}

/// Judges the candidates from `first` on, beside all.
void judge_from(std::size_t first, const JudgeOptions& options, std::vector<WedgeCandidate>* candidates) {
  std::vector<WedgeCandidate*> open;
  for (WedgeCandidate& c : *candidates) {
    if (c.rejected.empty()) {
      c.rejected = out_of_bounds(options, c);
    }
    if (c.rejected.empty()) {
      look_at(&c);
      open.push_back(&c);
    }
  }
  std::vector<const WedgeCandidate*> good;
  std::vector<double> depths;
  std::vector<double> widths;
  for (const WedgeCandidate* c : open) {
    if (kAlone.of(c->evidence) > kGoodOdds) {
      good.push_back(c);
      depths.push_back(c->wedge.depth_mm);
      widths.push_back(width_mm(*c));
    }
  }
  std::erase_if(open, [&](const WedgeCandidate* c) { return c < candidates->data() + first; });
  const bool enough = good.size() >= kFewest;
  const double typical_depth = enough ? median_of(std::move(depths)) : 0.0;
  const double typical_width = enough ? median_of(std::move(widths)) : 0.0;
  if (enough) {
    std::vector<std::uint8_t> is_good(candidates->size(), 0);
    for (const WedgeCandidate* c : good) {
      is_good[static_cast<std::size_t>(c - candidates->data())] = 1;
    }
    note_company(*candidates, is_good, typical_width, options.most_round, &open);
  }
  for (WedgeCandidate* c : open) {
    if (enough) {
      compare(good, typical_depth, typical_width, c);
    }
    const double odds = (enough ? kAmongOthers : kAlone).of(c->evidence);
    c->wedge.confidence = 1.0 / (1.0 + std::exp(-odds));
    if (c->wedge.confidence < options.least_confidence) {
      c->rejected = "confidence too low";
    }
  }
}

}  // namespace

void judge_wedges(const JudgeOptions& options, std::vector<WedgeCandidate>* candidates) {
  judge_from(0, options, candidates);
}

void judge_last_wedge(const JudgeOptions& options, std::vector<WedgeCandidate>* candidates) {
  judge_from(candidates->size() - 1, options, candidates);
}

}  // namespace dubsar
