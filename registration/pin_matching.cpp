// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Every three tips of one scan that have the mutual distances of three of the other give a pose; the tips
// that it brings together vote for it. The number of false alarms follows Moisan and Stival, A probabilistic
// criterion to detect rigid point matches, Int. J. Comput. Vis. 57 (2004).
#include "registration/pin_matching.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/units.h"
#include "registration/absolute_orientation.h"

namespace dubsar {

namespace {

using Pairs = std::vector<std::pair<int, int>>;

/// Tip sets beyond this are false detections for the most part; the best known ones are looked at.
constexpr std::size_t kMostTips = 20;
/// A triangle this flat says nothing of the turn about its longest side.
constexpr double kLeastHeightMm = 3.0;
/// Poses from three tips that are refined.
constexpr std::size_t kMostRefined = 48;
constexpr int kRefineRounds = 4;
/// Pins stand in a box about those seen, this much larger on each side.
constexpr double kBoxMarginMm = 2.0;

/// The tips of one scan with what the search asks of them.
struct Tips {
  std::vector<Eigen::Vector3d> at;
  std::vector<double> variance;  ///< per axis, the error of putting back included
  std::vector<int> label;
  std::vector<int> index;  ///< in the caller's list
  std::vector<double> distances;
  double volume_mm3 = 1;
  Eigen::Vector3d middle{0, 0, 0};

  [[nodiscard]] std::size_t size() const { return at.size(); }
  [[nodiscard]] double distance(std::size_t a, std::size_t b) const { return distances[a * size() + b]; }
};

Tips tips_of(const std::vector<SeenPin>& seen, const PinMatchOptions& options) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].position_mm.allFinite() && seen[k].covariance_mm2.allFinite()) {
      order.push_back(k);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const bool labelled_a = seen[a].label >= 0;
    const bool labelled_b = seen[b].label >= 0;
    return labelled_a != labelled_b ? labelled_a
                                    : seen[a].covariance_mm2.trace() < seen[b].covariance_mm2.trace();
  });
  order.resize(std::min(order.size(), kMostTips));
  std::sort(order.begin(), order.end());
  Tips tips;
  for (const std::size_t k : order) {
    tips.at.push_back(seen[k].position_mm);
    tips.variance.push_back(std::pow(options.replaced_sigma_mm, 2) / std::max(1, seen[k].placements) +
                            std::max(0.0, seen[k].covariance_mm2.trace() / 3.0));
    tips.label.push_back(seen[k].label);
    tips.index.push_back(static_cast<int>(k));
    tips.middle += seen[k].position_mm / static_cast<double>(order.size());
  }
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : tips.at) {
    moments += (p - tips.middle) * (p - tips.middle).transpose() / static_cast<double>(tips.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  for (int axis = 0; axis < 3; ++axis) {
    // A uniform distribution of standard deviation s is s·√12 wide.
    tips.volume_mm3 *= std::sqrt(12.0 * std::max(0.0, eigen.eigenvalues()[axis])) + 2.0 * kBoxMarginMm;
  }
  for (const Eigen::Vector3d& a : tips.at) {
    for (const Eigen::Vector3d& b : tips.at) {
      tips.distances.push_back((a - b).norm());
    }
  }
  return tips;
}

/// Axes of a triangle: x along its first side, z across its plane.
Eigen::Matrix3d triangle_axes(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Matrix3d axes;
  axes.col(0) = (b - a).normalized();
  axes.col(2) = (b - a).cross(c - a).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

class Matcher {
 public:
  Matcher(Tips source, Tips target, const PinMatchOptions& options)
      : source_(std::move(source)), target_(std::move(target)), options_(options) {
    for (std::size_t s = 0; s < source_.size(); ++s) {
      for (std::size_t t = 0; t < target_.size(); ++t) {
        variance_.push_back(source_.variance[s] + target_.variance[t]);
        const bool both = source_.label[s] >= 0 && target_.label[t] >= 0;
        // The other labels are taken to be as many as the larger set has tips.
        const double others =
            static_cast<double>(std::max<std::size_t>(2, std::max(source_.size(), target_.size())));
        const double same = std::log(options.label_is_right * others);
        const double other = std::log((1 - options.label_is_right) * others / (others - 1));
        label_score_.push_back(!both ? 0.0 : source_.label[s] == target_.label[t] ? same : other);
      }
    }
  }

  std::vector<PinMatch> run() {
    propose_by_labels();
    propose_by_distances();
    std::stable_sort(rough_.begin(), rough_.end(),
                     [](const Rough& a, const Rough& b) { return a.score > b.score; });
    std::vector<Rough> distinct;
    for (const Rough& r : rough_) {
      if (distinct.size() == kMostRefined) {
        break;
      }
      if (std::none_of(distinct.begin(), distinct.end(),
                       [&](const Rough& d) { return same(r.pose, d.pose, 0.5); })) {
        distinct.push_back(r);
      }
    }
    std::vector<PinMatch> refined;
    for (const Rough& r : distinct) {
      if (std::optional<PinMatch> match = refine(r.pose)) {
        refined.push_back(std::move(*match));
      }
    }
    std::stable_sort(refined.begin(), refined.end(),
                     [](const PinMatch& a, const PinMatch& b) { return a.score > b.score; });
    std::vector<PinMatch> out;
    for (PinMatch& m : refined) {
      const bool worth = out.size() < options_.most_candidates &&
                         (out.empty() || m.score >= out.front().score - options_.least_score_below_best);
      if (worth && std::none_of(out.begin(), out.end(), [&](const PinMatch& o) {
            return same(m.target_from_source, o.target_from_source, 1.0);
          })) {
        out.push_back(std::move(m));
      }
    }
    for (PinMatch& m : out) {
      m.chance = chance_of(m);
      for (auto& [s, t] : m.pairs) {
        s = source_.index[static_cast<std::size_t>(s)];
        t = target_.index[static_cast<std::size_t>(t)];
      }
    }
    return out;
  }

 private:
  struct Rough {
    RigidTransform pose;
    double score = 0;
  };

  [[nodiscard]] std::size_t at(std::size_t s, std::size_t t) const { return s * target_.size() + t; }

  [[nodiscard]] bool same(const RigidTransform& a, const RigidTransform& b, double part) const {
    const RigidTransform turn{a.rotation * b.rotation.transpose(), {0, 0, 0}};
    return turn.angle_rad() <= part * options_.distinct_turn_rad &&
           (a * source_.middle - b * source_.middle).norm() <= part * options_.distinct_shift_mm;
  }

  [[nodiscard]] bool distances_agree(std::size_t s1, std::size_t s2, std::size_t t1, std::size_t t2) const {
    const double off = source_.distance(s1, s2) - target_.distance(t1, t2);
    const double variance = variance_[at(s1, t1)] + variance_[at(s2, t2)];
    return off * off <= options_.distance_sigmas * options_.distance_sigmas * variance;
  }

  [[nodiscard]] bool flat(std::size_t a, std::size_t b, std::size_t c) const {
    const double longest = std::max({source_.distance(a, b), source_.distance(b, c), source_.distance(a, c)});
    const double area2 = (source_.at[b] - source_.at[a]).cross(source_.at[c] - source_.at[a]).norm();
    return !(area2 >= kLeastHeightMm * longest);
  }

  void propose(const std::array<std::size_t, 3>& s, const std::array<std::size_t, 3>& t) {
    RigidTransform pose;
    pose.rotation = triangle_axes(target_.at[t[0]], target_.at[t[1]], target_.at[t[2]]) *
                    triangle_axes(source_.at[s[0]], source_.at[s[1]], source_.at[s[2]]).transpose();
    const Eigen::Vector3d from = (source_.at[s[0]] + source_.at[s[1]] + source_.at[s[2]]) / 3.0;
    const Eigen::Vector3d to = (target_.at[t[0]] + target_.at[t[1]] + target_.at[t[2]]) / 3.0;
    pose.translation_mm = to - pose.rotation * from;
    if (!pose.rotation.allFinite()) {
      return;
    }
    // A pose from three tips is off by a few of their errors at the others.
    const double reach2 = std::pow(2.0 * options_.outlier_sigmas * options_.replaced_sigma_mm, 2);
    double score = 0;
    for (std::size_t a = 0; a < source_.size(); ++a) {
      const Eigen::Vector3d p = pose * source_.at[a];
      double best = 0;
      for (std::size_t b = 0; b < target_.size(); ++b) {
        const double d2 = (p - target_.at[b]).squaredNorm();
        if (d2 < reach2) {
          best = std::max(best, 1.0 - 0.8 * d2 / reach2 + 0.15 * label_score_[at(a, b)]);
        }
      }
      score += best;
    }
    rough_.push_back({pose, score});
  }

  void propose_by_labels() {
    std::vector<std::array<std::size_t, 2>> pairs;
    for (std::size_t s = 0; s < source_.size(); ++s) {
      for (std::size_t t = 0; t < target_.size(); ++t) {
        if (source_.label[s] >= 0 && source_.label[s] == target_.label[t]) {
          pairs.push_back({s, t});
        }
      }
    }
    for (std::size_t a = 0; a < pairs.size(); ++a) {
      for (std::size_t b = a + 1; b < pairs.size(); ++b) {
        for (std::size_t c = b + 1; c < pairs.size(); ++c) {
          const auto agree = [&](std::size_t i, std::size_t j) {
            return pairs[i][0] != pairs[j][0] && pairs[i][1] != pairs[j][1] &&
                   distances_agree(pairs[i][0], pairs[j][0], pairs[i][1], pairs[j][1]);
          };
          if (agree(a, b) && agree(a, c) && agree(b, c) && !flat(pairs[a][0], pairs[b][0], pairs[c][0])) {
            propose({pairs[a][0], pairs[b][0], pairs[c][0]}, {pairs[a][1], pairs[b][1], pairs[c][1]});
          }
        }
      }
    }
  }

  void propose_by_distances() {
    const std::size_t n = target_.size();
    for (std::size_t a = 0; a < source_.size(); ++a) {
      for (std::size_t b = a + 1; b < source_.size(); ++b) {
        for (std::size_t ta = 0; ta < n; ++ta) {
          for (std::size_t tb = 0; tb < n; ++tb) {
            if (ta == tb || !distances_agree(a, b, ta, tb)) {
              continue;
            }
            for (std::size_t c = b + 1; c < source_.size(); ++c) {
              if (flat(a, b, c)) {
                continue;
              }
              for (std::size_t tc = 0; tc < n; ++tc) {
                if (tc != ta && tc != tb && distances_agree(a, c, ta, tc) && distances_agree(b, c, tb, tc)) {
                  propose({a, b, c}, {ta, tb, tc});
                }
              }
            }
          }
        }
      }
    }
  }

  /// Pairs that the pose brings together, each tip once, likeliest first.
  [[nodiscard]] Pairs inliers(const RigidTransform& pose, double sigmas) const {
    std::vector<std::pair<double, std::pair<int, int>>> near;
    for (std::size_t s = 0; s < source_.size(); ++s) {
      const Eigen::Vector3d p = pose * source_.at[s];
      for (std::size_t t = 0; t < target_.size(); ++t) {
        const double d2 = (p - target_.at[t]).squaredNorm();
        if (d2 <= sigmas * sigmas * variance_[at(s, t)]) {
          near.push_back({0.5 * d2 / variance_[at(s, t)] - label_score_[at(s, t)],
                          {static_cast<int>(s), static_cast<int>(t)}});
        }
      }
    }
    std::sort(near.begin(), near.end());
    std::vector<bool> used_source(source_.size(), false);
    std::vector<bool> used_target(target_.size(), false);
    Pairs out;
    for (const auto& [cost, pair] : near) {
      const auto s = static_cast<std::size_t>(pair.first);
      const auto t = static_cast<std::size_t>(pair.second);
      if (!used_source[s] && !used_target[t]) {
        used_source[s] = used_target[t] = true;
        out.push_back(pair);
      }
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  [[nodiscard]] std::optional<RigidTransform> solve(const Pairs& pairs) const {
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    std::vector<double> weights;
    for (const auto& [s, t] : pairs) {
      from.push_back(source_.at[static_cast<std::size_t>(s)]);
      to.push_back(target_.at[static_cast<std::size_t>(t)]);
      weights.push_back(1.0 / variance_[at(static_cast<std::size_t>(s), static_cast<std::size_t>(t))]);
    }
    return absolute_orientation(from, to, weights);
  }

  [[nodiscard]] std::optional<PinMatch> refine(const RigidTransform& start) const {
    PinMatch match;
    match.target_from_source = start;
    match.pairs = inliers(start, 1.5 * options_.outlier_sigmas);
    for (int round = 0; round < kRefineRounds && match.pairs.size() >= 3; ++round) {
      const std::optional<RigidTransform> better = solve(match.pairs);
      if (!better) {
        return std::nullopt;
      }
      match.target_from_source = *better;
      Pairs again = inliers(*better, options_.outlier_sigmas);
      const bool settled = again == match.pairs;
      match.pairs = std::move(again);
      if (settled) {
        break;
      }
    }
    double sum2 = 0;
    for (const auto& [s, t] : match.pairs) {
      const std::size_t k = at(static_cast<std::size_t>(s), static_cast<std::size_t>(t));
      const double d2 = (match.target_from_source * source_.at[static_cast<std::size_t>(s)] -
                         target_.at[static_cast<std::size_t>(t)])
                            .squaredNorm();
      const double likelihood = -1.5 * std::log(2.0 * kPi * variance_[k]) - 0.5 * d2 / variance_[k];
      const double by_chance = std::log(static_cast<double>(target_.size()) / target_.volume_mm3);
      match.score += likelihood - by_chance + label_score_[k];
      sum2 += d2;
      const int label = source_.label[static_cast<std::size_t>(s)];
      match.labels_agree += label >= 0 && label == target_.label[static_cast<std::size_t>(t)] ? 1 : 0;
    }
    const auto count = static_cast<int>(match.pairs.size());
    const bool enough = match.labels_agree >= options_.least_labelled || count >= options_.least_unlabelled;
    if (count < 3 || !enough || spread_mm(match.pairs) < kLeastHeightMm) {
      return std::nullopt;
    }
    match.rms_mm = std::sqrt(sum2 / count);
    return match;
  }

  /// Standard deviation of the matched tips across the line that they lie along.
  [[nodiscard]] double spread_mm(const Pairs& pairs) const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& [s, t] : pairs) {
      mean += source_.at[static_cast<std::size_t>(s)] / static_cast<double>(pairs.size());
    }
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const auto& [s, t] : pairs) {
      const Eigen::Vector3d d = source_.at[static_cast<std::size_t>(s)] - mean;
      moments += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
    return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
  }

  /// Triples of the one set with triples of the other, times the chance that of the remaining tips as many
  /// fall as near: for the distance at which this is least.
  [[nodiscard]] double chance_of(const PinMatch& match) const {
    const auto n = static_cast<double>(source_.size());
    const auto m = static_cast<double>(target_.size());
    const double tests = n * (n - 1) * (n - 2) / 6.0 * m * (m - 1) * (m - 2);
    std::vector<double> off;
    for (const auto& [s, t] : match.pairs) {
      off.push_back((match.target_from_source * source_.at[static_cast<std::size_t>(s)] -
                     target_.at[static_cast<std::size_t>(t)])
                        .norm());
    }
    std::sort(off.begin(), off.end());
    double least = tests;
    for (std::size_t k = 3; k < off.size(); ++k) {
      const double p = std::min(1.0, m * 4.0 / 3.0 * kPi * std::pow(off[k], 3) / target_.volume_mm3);
      // At least k + 1 - 3 of the n - 3 others; every k is a test of its own.
      double tail = 0;
      const auto others = static_cast<int>(source_.size()) - 3;
      for (int i = static_cast<int>(k) - 2; i <= others; ++i) {
        tail +=
            std::exp(std::lgamma(others + 1.0) - std::lgamma(i + 1.0) - std::lgamma(others - i + 1.0) +
                     i * std::log(std::max(p, 1e-300)) + (others - i) * std::log1p(-std::min(p, 1 - 1e-12)));
      }
      least = std::min(least, tests * n * tail);
    }
    return least;
  }

  Tips source_;
  Tips target_;
  PinMatchOptions options_;
  std::vector<double> variance_;     ///< [source × target] per axis of a pair's difference
  std::vector<double> label_score_;  ///< [source × target] log likelihood ratio of their labels
  std::vector<Rough> rough_;
};

}  // namespace

std::vector<PinMatch> match_pins(const std::vector<SeenPin>& source, const std::vector<SeenPin>& target,
                                 const PinMatchOptions& options) {
  return Matcher(tips_of(source, options), tips_of(target, options), options).run();
}

}  // namespace dubsar
