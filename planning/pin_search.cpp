// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Exchange search over sets of views as bits: one bit per view and candidate (stands and shows), one per view
// and pair (the first's tip is behind the second).
#include "planning/pin_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "core/parallel.h"
#include "core/random.h"
#include "core/sphere_directions.h"
#include "planning/convex_hull.h"

namespace dubsar {

namespace {

constexpr std::size_t kSearchDirections = 512;  // about 9 degrees apart
constexpr std::size_t kSearchRolls = 12;
constexpr double kSearchMargin = 0.02;  // what holds in a view holds a degree beside it
/// Candidates that go into the exchange: those that show in most views, alone.
constexpr std::size_t kMostCandidates = 320;

constexpr std::size_t kKickedPins = 4;
constexpr std::uint64_t kSearchSeed = 15;

using Bits = std::vector<std::uint64_t>;

struct Views {
  std::vector<Sightline> lasers;   // [directions]
  std::vector<Sightline> cameras;  // [directions * rolls]
  std::size_t words = 0;

  [[nodiscard]] std::size_t count() const { return cameras.size(); }
};

Views search_views(const TabletHull& hull, const PinLayoutOptions& options) {
  Views views;
  for (const Eigen::Vector3d& laser : sphere_directions(kSearchDirections)) {
    views.lasers.emplace_back(hull, laser, kSearchMargin);
    for (std::size_t r = 0; r < kSearchRolls; ++r) {
      const double roll = 2.0 * kPi * static_cast<double>(r) / static_cast<double>(kSearchRolls);
      views.cameras.emplace_back(hull, sight_view(laser, roll, options.triangulation_rad).to_camera,
                                 kSearchMargin);
    }
  }
  views.words = (views.count() + 63) / 64;
  return views;
}

template <class Test>
Bits bits_of(const Views& views, const Test& test) {
  Bits bits(views.words, 0);
  for (std::size_t v = 0; v < views.count(); ++v) {
    if (test(v)) {
      bits[v / 64] |= std::uint64_t{1} << (v % 64);
    }
  }
  return bits;
}

std::size_t ones(const Bits& bits) {
  std::size_t n = 0;
  for (const std::uint64_t word : bits) {
    n += static_cast<std::size_t>(std::popcount(word));
  }
  return n;
}

/// How good a set is. `soft` sums 8^-seen over the views: views with few pins weigh, so that the search finds
/// its way before the least count moves.
struct Worth {
  int least = 0;
  std::size_t at_least = 0;
  std::size_t total = 0;
  std::uint64_t soft = 0;

  [[nodiscard]] bool softer_than(const Worth& other) const { return soft < other.soft; }
  [[nodiscard]] bool better_than(const Worth& other) const {
    return std::tuple(-least, other.total) < std::tuple(-other.least, total);
  }
};

class Exchange {
 public:
  Exchange(const TabletHull& hull, const std::vector<PlannedPin>& candidates, const PinLayoutOptions& options)
      : options_(options), views_(search_views(hull, options)) {
    std::vector<PinBody> all;
    for (const PlannedPin& pin : candidates) {
      all.emplace_back(hull, pin.pose, options.shape);
    }
    std::vector<Bits> shows(all.size());
    parallel_for_each_index(
        all.size(),
        [&](std::size_t i) {
          std::vector<char> free(views_.lasers.size());
          for (std::size_t d = 0; d < free.size(); ++d) {
            free[d] = all[i].tip_is_free(views_.lasers[d]) ? 1 : 0;
          }
          shows[i] = bits_of(views_, [&](std::size_t v) {
            return free[v / kSearchRolls] != 0 &&
                   stands_and_shows(all[i], views_.lasers[v / kSearchRolls], views_.cameras[v]);
          });
        },
        1);
    std::vector<std::size_t> order(all.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return ones(shows[a]) > ones(shows[b]); });
    order.resize(std::min(order.size(), kMostCandidates));
    std::sort(order.begin(), order.end());
    for (const std::size_t i : order) {
      original_.push_back(i);
      bodies_.push_back(all[i]);
      shows_.push_back(std::move(shows[i]));
    }
    fill_pairs();
  }

  [[nodiscard]] std::size_t size() const { return bodies_.size(); }
  [[nodiscard]] std::size_t original(std::size_t i) const { return original_[i]; }
  [[nodiscard]] bool apart(std::size_t i, std::size_t j) const { return apart_[i * size() + j] != 0; }

  [[nodiscard]] Worth worth(const std::vector<std::size_t>& set) const {
    std::array<std::size_t, kMostPins + 1> views_with{};
    const std::size_t tail = views_.words * 64 - views_.count();
    for (std::size_t w = 0; w < views_.words; ++w) {
      std::array<std::uint64_t, 4> sum{};  // a binary counter per view
      for (const std::size_t i : set) {
        std::uint64_t seen = shows_[i][w];
        for (const std::size_t j : set) {
          const Bits& behind = behind_[i * size() + j];
          seen &= behind.empty() ? ~std::uint64_t{0} : ~(behind[w] & shows_[j][w]);
        }
        for (std::uint64_t& digit : sum) {
          const std::uint64_t carry = digit & seen;
          digit ^= seen;
          seen = carry;
        }
      }
      for (std::size_t n = 0; n <= set.size(); ++n) {
        std::uint64_t equal = ~std::uint64_t{0};
        for (std::size_t d = 0; d < sum.size(); ++d) {
          equal &= ((n >> d) & 1U) != 0 ? sum[d] : ~sum[d];
        }
        views_with[n] += static_cast<std::size_t>(std::popcount(equal));
      }
    }
    views_with[0] -= tail;  // bits past the last view
    Worth worth;
    worth.least = -1;
    for (std::size_t n = 0; n <= kMostPins; ++n) {
      if (worth.least < 0 && views_with[n] > 0) {
        worth.least = static_cast<int>(n);
        worth.at_least = views_with[n];
      }
      worth.total += n * views_with[n];
      worth.soft += static_cast<std::uint64_t>(views_with[n]) << (3 * (kMostPins - n));
    }
    return worth;
  }

  /// Adds the best candidate again and again until there are `count`.
  void fill(std::vector<std::size_t>& set, std::size_t count) const {
    while (set.size() < count) {
      std::vector<std::size_t> best = set;
      if (!best_change(set, set.size(), false, best)) {
        return;
      }
      set = best;
    }
  }

  /// Exchanges one pin for another as long as that betters the set.
  void improve(std::vector<std::size_t>& set, bool strict, int rounds, const JobContext& job) const {
    for (int round = 0; round < rounds && !job.cancelled(); ++round) {
      bool changed = false;
      for (std::size_t slot = 0; slot < set.size(); ++slot) {
        changed = best_change(set, slot, strict, set) || changed;
      }
      if (!changed) {
        return;
      }
    }
  }

 private:
  void fill_pairs() {
    const std::size_t n = size();
    behind_.resize(n * n);
    apart_.resize(n * n, 0);
    parallel_for_each_index(
        n * n,
        [&](std::size_t pair) {
          const PinBody& a = bodies_[pair / n];
          const PinBody& b = bodies_[pair % n];
          const double tips_mm = (a.tip().center_mm - b.tip().center_mm).norm();
          if (tips_mm < options_.tip_spacing_mm || a.distance_mm(b) < 0) {
            return;
          }
          apart_[pair] = 1;
          const PinBody::Shield shield = a.shield_of(b, kSearchMargin);
          const auto behind = [&](const Sightline& to) {
            return to.direction().dot(shield.axis) >= shield.least_cosine && a.tip_is_behind(b, to);
          };
          std::vector<char> laser(views_.lasers.size());
          for (std::size_t d = 0; d < laser.size(); ++d) {
            laser[d] = behind(views_.lasers[d]) ? 1 : 0;
          }
          Bits bits = bits_of(views_, [&](std::size_t v) {
            return laser[v / kSearchRolls] != 0 || behind(views_.cameras[v]);
          });
          if (ones(bits) > 0) {
            behind_[pair] = std::move(bits);
          }
        },
        16);
  }

  /// Puts the candidate at `slot` that makes the set best (at the end: adds it) into `best`; false when
  /// nothing is better than what is there.
  bool best_change(const std::vector<std::size_t>& set, std::size_t slot, bool strict,
                   std::vector<std::size_t>& best) const {
    const std::vector<std::size_t> start = set;
    std::vector<Worth> worths(size());
    std::vector<char> allowed(size(), 0);
    parallel_for_each_index(
        size(),
        [&](std::size_t c) {
          std::vector<std::size_t> trial = start;
          for (std::size_t k = 0; k < start.size(); ++k) {
            if (k != slot && !apart(c, start[k])) {
              return;
            }
          }
          if (slot < trial.size()) {
            trial[slot] = c;
          } else {
            trial.push_back(c);
          }
          allowed[c] = 1;
          worths[c] = worth(trial);
        },
        8);
    const auto better = [&](const Worth& a, const Worth& b) {
      return strict ? a.better_than(b) : a.softer_than(b);
    };
    std::size_t found = slot < start.size() ? start[slot] : size();
    for (std::size_t c = 0; c < size(); ++c) {
      if (allowed[c] != 0 && (found == size() || better(worths[c], worths[found]))) {
        found = c;
      }
    }
    if (found == size() || (slot < start.size() && found == start[slot])) {
      return false;
    }
    best = start;
    if (slot < best.size()) {
      best[slot] = found;
    } else {
      best.push_back(found);
    }
    return true;
  }

  const PinLayoutOptions& options_;
  Views views_;
  std::vector<std::size_t> original_;
  std::vector<PinBody> bodies_;
  std::vector<Bits> shows_;
  std::vector<Bits> behind_;  // [n * n], empty: in no view
  std::vector<char> apart_;   // [n * n]
};

/// The candidate nearest to each wished place that keeps its distance.
std::vector<std::size_t> snapped(const Exchange& exchange, const std::vector<PlannedPin>& candidates,
                                 const std::vector<Eigen::Vector3d>& wishes, std::size_t count) {
  std::vector<std::size_t> set;
  for (const Eigen::Vector3d& wish : wishes) {
    std::size_t nearest = exchange.size();
    double least = 0;
    for (std::size_t c = 0; c < exchange.size(); ++c) {
      const bool free =
          std::all_of(set.begin(), set.end(), [&](std::size_t s) { return exchange.apart(c, s); });
      const double distance = (candidates[exchange.original(c)].pose.tip_mm - wish).norm();
      if (free && (nearest == exchange.size() || distance < least)) {
        nearest = c;
        least = distance;
      }
    }
    if (nearest < exchange.size() && set.size() < count) {
      set.push_back(nearest);
    }
  }
  return set;
}

}  // namespace

std::vector<std::size_t> search_pins(const TabletHull& hull, const std::vector<PlannedPin>& candidates,
                                     const PinLayoutOptions& options, const JobContext& job) {
  job.progress("pins: views", 0.0);
  const Exchange exchange(hull, candidates, options);
  const auto count = static_cast<std::size_t>(options.count);
  std::vector<Eigen::Vector3d> corners;
  for (const double z : {1.0, -1.0}) {
    for (const double x : {1.0, -1.0}) {
      for (const double y : {1.0, -1.0}) {
        corners.emplace_back(hull.half_mm.cwiseProduct(Eigen::Vector3d(x, y, z)));
      }
    }
  }
  std::vector<Eigen::Vector3d> ring;
  for (std::size_t i = 0; i < count; ++i) {
    const double azimuth = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(count);
    const double up = i % 2 == 0 ? 1.0 : -1.0;
    ring.emplace_back(hull.half_mm.cwiseProduct(Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), up)));
  }
  std::vector<std::size_t> best;
  Worth best_worth;
  const auto keep_better = [&](const std::vector<std::size_t>& set) {
    const Worth worth = exchange.worth(set);
    if (best.empty() || set.size() > best.size() ||
        (set.size() == best.size() && worth.better_than(best_worth))) {
      best = set;
      best_worth = worth;
    }
  };
  const std::array<std::vector<Eigen::Vector3d>, 3> starts{std::vector<Eigen::Vector3d>{}, corners, ring};
  for (std::size_t s = 0; s < starts.size() && !job.cancelled(); ++s) {
    job.progress("pins: search", 0.1);
    std::vector<std::size_t> set = snapped(exchange, candidates, starts[s], count);
    exchange.fill(set, count);
    exchange.improve(set, false, options.search_rounds, job);
    keep_better(set);
  }
  // Out of the local optimum: some pins taken away by chance, then put back where they are best.
  Random random(seed_for(kSearchSeed, candidates.size()));
  std::vector<std::size_t> around = best;
  Worth around_worth = exchange.worth(around);
  for (int kick = 0; kick < options.search_rounds && !job.cancelled(); ++kick) {
    job.progress("pins: search", 0.2 + 0.4 * kick / options.search_rounds);
    std::vector<std::size_t> set = around;
    for (std::size_t k = 0; k < kKickedPins && set.size() > 1; ++k) {
      set.erase(set.begin() + static_cast<std::ptrdiff_t>(random.below(set.size())));
    }
    exchange.fill(set, count);
    exchange.improve(set, false, options.search_rounds, job);
    const Worth worth = exchange.worth(set);
    if (set.size() == count && worth.softer_than(around_worth)) {
      around = set;
      around_worth = worth;
    }
    keep_better(set);
  }
  exchange.improve(best, true, options.search_rounds, job);
  for (std::size_t& i : best) {
    i = exchange.original(i);
  }
  return best;
}

}  // namespace dubsar
