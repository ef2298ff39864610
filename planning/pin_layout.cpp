// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/pin_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning/pin_search.h"

namespace dubsar {

namespace {

double azimuth(const PlannedPin& pin) {
  // From the middle of the right edge on; a hair before it counts as it, so that rounding does not decide.
  const double angle = std::atan2(pin.rim_mm.y(), pin.rim_mm.x());
  return angle < -1e-9 ? angle + 2.0 * kPi : angle;
}

}  // namespace

Status PinLayoutOptions::check() const {
  const auto bad = [](const char* what) { return fail(ErrorKind::kUsage, what, "pin layout"); };
  if (count < 3 || count > static_cast<int>(kMostPins)) {
    return bad("the number of pins must be 3 to 15");
  }
  if (!(shape.tip_radius_mm > 0) || !(shape.gap_mm > 0) || !(shape.arm_radius_mm >= shape.tip_radius_mm) ||
      !(shape.arm_length_mm > 0)) {
    return bad("a pin needs a tip, a gap and an arm that does not thin out");
  }
  if (!(triangulation_rad >= 0 && triangulation_rad < 0.5 * kPi)) {
    return bad("the angle between laser and camera must be at least 0 and below 90 degrees");
  }
  if (!(tip_spacing_mm >= 0) || directions < 1 || rolls < 1 || search_rounds < 0 || proof_views < 1) {
    return bad("counts and distances must not be negative");
  }
  return {};
}

Result<PinLayout> plan_pin_layout(const TabletHull& hull, double rim_radius_mm,
                                  const PinLayoutOptions& options, const JobContext& job) {
  if (const Status checked = options.check(); !checked) {
    return std::unexpected(checked.error());
  }
  if (hull.normals.empty() || !(hull.half_mm.minCoeff() > 0) || !hull.half_mm.allFinite()) {
    return fail(ErrorKind::kUsage, "the tablet has no size", "pin layout", "give its three sides in mm");
  }
  const std::vector<PlannedPin> candidates = rim_candidates(hull, rim_radius_mm, options);
  const std::vector<std::size_t> chosen = search_pins(hull, candidates, options, job);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped", "pin layout");
  }
  if (static_cast<int>(chosen.size()) < options.count) {
    return fail(ErrorKind::kUsage, "the rim has no room for so many pins", "pin layout",
                "take fewer pins, or thinner ones");
  }
  PinLayout layout;
  layout.size_mm = 2.0 * hull.half_mm;
  for (const std::size_t i : chosen) {
    layout.pins.push_back(candidates[i]);
  }
  std::stable_sort(layout.pins.begin(), layout.pins.end(), [](const PlannedPin& a, const PlannedPin& b) {
    const double first = azimuth(a);
    const double second = azimuth(b);
    return std::abs(first - second) > 1e-9 ? first < second : a.rim_mm.z() > b.rim_mm.z();
  });
  std::vector<PinBody> bodies;
  for (PlannedPin& pin : layout.pins) {
    bodies.emplace_back(hull, pin.pose, options.shape);
    pin.number = static_cast<int>(bodies.size());
  }
  job.progress("pins: counting", 0.7);
  layout.census = count_pins_seen(hull, bodies, options);
  job.progress("pins: proof", 0.8);
  layout.proven = layout.census.least;
  while (layout.proven > 0 && !at_least_seen_everywhere(hull, bodies, layout.proven, options, job)) {
    --layout.proven;
  }
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped", "pin layout");
  }
  job.progress("pins: proof", 1.0);
  return layout;
}

}  // namespace dubsar
