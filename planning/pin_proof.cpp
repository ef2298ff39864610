// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Counting the pins that are seen: over enumerated views, and over all views by subdivision.
//
// Why cells prove it. A cell of laser directions has a centre l0 and a chord radius m: each l of the cell
// differs from l0 by at most m. Turn the view (l, c) by the least rotation that takes l to l0: c comes to a
// c' beside l0, at a roll that one of the intervals about l0 holds, and |c - c'| <= m, as no unit vector
// moves by more than the rotation's chord. With c0 at the middle of an interval of half width h, |c' - c0| <=
// h sin(triangulation). So (l, c) lies within m of l0 and m + h sin(triangulation) of c0, the margins that
// the tests are given.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/sphere_directions.h"
#include "planning/convex_hull.h"
#include "planning/pin_layout.h"

namespace dubsar {

namespace {

/// Pins that are seen in every view within the margins; stops as soon as there are `enough`, or cannot be.
int pins_seen(const std::vector<PinBody>& pins, const Sightline& laser, const Sightline& camera, int enough) {
  std::array<char, kMostPins> shows{};
  std::array<char, kMostPins> stands{};  // may stand
  int most = 0;
  for (std::size_t i = 0; i < pins.size(); ++i) {
    shows[i] = stands_and_shows(pins[i], laser, camera) ? 1 : 0;
    most += shows[i];
    if (most + static_cast<int>(pins.size() - i) - 1 < enough) {
      return most;
    }
  }
  for (std::size_t i = 0; i < pins.size(); ++i) {
    stands[i] = shows[i] != 0 || !never_stands_and_shows(pins[i], laser, camera) ? 1 : 0;
  }
  int seen = 0;
  for (std::size_t i = 0; i < pins.size() && (enough == 0 || seen < enough); ++i) {
    bool clear = shows[i] != 0;
    for (std::size_t j = 0; clear && j < pins.size(); ++j) {
      clear = i == j || stands[j] == 0 ||
              !(pins[i].tip_is_behind(pins[j], laser) || pins[i].tip_is_behind(pins[j], camera));
    }
    seen += clear ? 1 : 0;
  }
  return seen;
}

/// A square of one side of a cube, seen from the cube's centre.
struct Cell {
  int side = 0;
  double u = 0, v = 0, half = 1;  // of the side's coordinates in [-1, 1]

  [[nodiscard]] Eigen::Vector3d direction(double at_u, double at_v) const {
    Eigen::Vector3d d;
    const int axis = side / 2;
    d[axis] = side % 2 == 0 ? 1.0 : -1.0;
    d[(axis + 1) % 3] = at_u;
    d[(axis + 2) % 3] = at_v;
    return d.normalized();
  }
};

class Prover {
 public:
  Prover(const TabletHull& hull, const std::vector<PinBody>& pins, int least, const PinLayoutOptions& options)
      : hull_(hull), pins_(pins), least_(least), options_(options) {}

  [[nodiscard]] bool holds(const Cell& root, const std::atomic<bool>& stop) const {
    std::vector<Cell> open{root};
    int views_left = options_.proof_views;
    while (!open.empty()) {
      if (views_left <= 0 || stop.load(std::memory_order_relaxed)) {
        return false;
      }
      const Cell cell = open.back();
      open.pop_back();
      switch (judge(cell, views_left)) {
        case Verdict::kHolds:
          break;
        case Verdict::kBroken:
          return false;
        case Verdict::kTooCoarse:
          for (const double du : {-0.5, 0.5}) {
            for (const double dv : {-0.5, 0.5}) {
              open.push_back({cell.side, cell.u + du * cell.half, cell.v + dv * cell.half, 0.5 * cell.half});
            }
          }
          break;
      }
    }
    return true;
  }

 private:
  enum class Verdict { kHolds, kTooCoarse, kBroken };
  struct Rolls {
    double middle, half;
  };

  [[nodiscard]] Verdict judge(const Cell& cell, int& views_left) const {
    const Eigen::Vector3d center = cell.direction(cell.u, cell.v);
    // The cell's sides are great circles: no direction in it is farther from the centre than a corner.
    double radius = 0;
    for (const double du : {-cell.half, cell.half}) {
      for (const double dv : {-cell.half, cell.half}) {
        radius = std::max(radius, (cell.direction(cell.u + du, cell.v + dv) - center).norm());
      }
    }
    const Sightline laser(hull_, center, radius);
    const double lever = std::sin(options_.triangulation_rad);
    std::vector<Rolls> open;
    constexpr int kIntervals = 8;
    for (int i = 0; i < kIntervals; ++i) {
      open.push_back({2.0 * kPi * i / kIntervals, kPi / kIntervals});
    }
    while (!open.empty() && views_left-- > 0) {
      const Rolls rolls = open.back();
      open.pop_back();
      const SightView view = sight_view(center, rolls.middle, options_.triangulation_rad);
      const double sweep = lever * rolls.half;
      if (pins_seen(pins_, laser, Sightline(hull_, view.to_camera, radius + sweep), least_) >= least_) {
        continue;
      }
      if (sweep > 0.7 * radius) {
        open.push_back({rolls.middle - 0.5 * rolls.half, 0.5 * rolls.half});
        open.push_back({rolls.middle + 0.5 * rolls.half, 0.5 * rolls.half});
        continue;
      }
      const bool broken = pins_seen(pins_, Sightline(hull_, center, 0.0),
                                    Sightline(hull_, view.to_camera, 0.0), least_) < least_;
      return broken ? Verdict::kBroken : Verdict::kTooCoarse;
    }
    return open.empty() ? Verdict::kHolds : Verdict::kTooCoarse;
  }

  const TabletHull& hull_;
  const std::vector<PinBody>& pins_;
  int least_;
  const PinLayoutOptions& options_;
};

}  // namespace

PinCensus count_pins_seen(const TabletHull& hull, const std::vector<PinBody>& pins,
                          const PinLayoutOptions& options) {
  const std::vector<Eigen::Vector3d> lasers =
      sphere_directions(static_cast<std::size_t>(std::max(1, options.directions)));
  const auto rolls = static_cast<std::size_t>(std::max(1, options.rolls));
  std::vector<int> seen(lasers.size() * rolls);
  const auto view_at = [&](std::size_t i) {
    return sight_view(lasers[i / rolls],
                      2.0 * kPi * static_cast<double>(i % rolls) / static_cast<double>(rolls),
                      options.triangulation_rad);
  };
  parallel_for_each_index(
      seen.size(),
      [&](std::size_t i) {
        const SightView view = view_at(i);
        seen[i] =
            pins_seen(pins, Sightline(hull, view.to_laser, 0.0), Sightline(hull, view.to_camera, 0.0), 0);
      },
      64);
  PinCensus census;
  const auto least = std::min_element(seen.begin(), seen.end());
  census.least = *least;
  census.worst = view_at(static_cast<std::size_t>(least - seen.begin()));
  for (const int n : seen) {
    ++census.views_with[static_cast<std::size_t>(n)];
    census.mean += n;
  }
  census.mean /= static_cast<double>(seen.size());
  return census;
}

bool at_least_seen_everywhere(const TabletHull& hull, const std::vector<PinBody>& pins, int least,
                              const PinLayoutOptions& options, const JobContext& job) {
  if (least <= 0) {
    return true;
  }
  const Prover prover(hull, pins, least, options);
  constexpr int kAcross = 4;
  std::vector<Cell> roots;
  for (int side = 0; side < 6; ++side) {
    for (int i = 0; i < kAcross * kAcross; ++i) {
      const auto middle = [](int step) { return (2.0 * step + 1.0) / kAcross - 1.0; };
      roots.push_back({side, middle(i % kAcross), middle(i / kAcross), 1.0 / kAcross});
    }
  }
  std::atomic<bool> broken{false};  // only cuts short what is false in any case
  parallel_for_each_index(
      roots.size(),
      [&](std::size_t i) {
        if (job.cancelled() || !prover.holds(roots[i], broken)) {
          broken.store(true, std::memory_order_relaxed);
        }
      },
      1);
  return !broken.load();
}

}  // namespace dubsar
