// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "core/units.h"
#include "planning/pin_sight.h"
#include "planning/tablet_hull.h"

namespace dubsar {

inline constexpr std::size_t kMostPins = 15;  ///< that a layout may have (seed 001, 3.2)
/// With fewer seen in some view the first pose of a scan has little redundancy: a warning.
inline constexpr int kFewPinsSeen = 6;

struct PinLayoutOptions {
  int count = 15;  ///< 3 to kMostPins
  PinShape shape;
  double triangulation_rad = rad_from_deg(24.0);  ///< between laser and camera; 0: seen from one point
  double tip_spacing_mm = 4.0;  ///< least, between two tip centres: nearer pins are mixed up
  int directions = 1600;        ///< of the laser, over the whole sphere, that are enumerated
  int rolls = 24;               ///< of the camera about the laser, for each
  int search_rounds = 30;       ///< of exchange, and of starts anew, at most
  int proof_views = 3000;  ///< cells of views into which each 1/96 of the sphere may be cut for the proof

  [[nodiscard]] Status check() const;
};

/// One pin of a layout, in the tablet frame.
struct PlannedPin {
  int number = 0;                   ///< from 1, anticlockwise round the rim as seen from the obverse
  Eigen::Vector3d rim_mm{0, 0, 0};  ///< the point of the rim that the tip points at
  PinPose pose;
};

/// How many pins of a layout are seen (pin_sight.h) over the enumerated views.
struct PinCensus {
  std::array<std::size_t, kMostPins + 1> views_with{};  ///< [n] views in which just n pins are seen
  int least = 0;
  double mean = 0;
  SightView worst;  ///< the first view with the least
};

struct PinLayout {
  Eigen::Vector3d size_mm{0, 0, 0};
  std::vector<PlannedPin> pins;
  PinCensus census;
  /// This many pins are seen in every view whatever, not only in the enumerated ones: proven by covering all
  /// directions and rolls with cells (see least_pins_proven). At most census.least.
  int proven = 0;
};

/// Counts over laser directions spread evenly over the sphere, times rolls spread evenly.
[[nodiscard]] PinCensus count_pins_seen(const TabletHull& hull, const std::vector<PinBody>& pins,
                                        const PinLayoutOptions& options);

/// True when at least `least` pins are seen in every view. The sphere of laser directions is cut into cells,
/// each with all rolls cut into intervals; a pin counts in a cell only when it is seen, with the tests'
/// margins opened to the cell's radius, from every view of the cell. Cells with too few are cut into four,
/// down to options.proof_views; cells that then remain, or a view with fewer, make it false.
[[nodiscard]] bool at_least_seen_everywhere(const TabletHull& hull, const std::vector<PinBody>& pins,
                                            int least, const PinLayoutOptions& options,
                                            const JobContext& job);

/// Points near the rim, fifteen or options.count (the edges of the tablet and the sides between them), such
/// that as many pins as possible are seen from every view: greedy exchange over candidate points from several
/// starts, the least count over a coarser set of views first, then the mean. rim_radius_mm tells where the
/// edges begin to bend. Same input, same bytes. Errors: bad options or a hull with no size (kUsage),
/// cancelled.
[[nodiscard]] Result<PinLayout> plan_pin_layout(const TabletHull& hull, double rim_radius_mm,
                                                const PinLayoutOptions& options, const JobContext& job);

}  // namespace dubsar
