// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/motion_limits.h"

#include <algorithm>
#include <cmath>

#include "core/keep_out.h"
#include "core/number_text.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// Half a microradian, and a thousandth of a micrometre: what a round trip through degrees or metres may
/// cost.
constexpr double kSlackRad = 5e-7;
constexpr double kSlackMm = 1e-6;

struct Quantity {
  const char* name;
  const char* unit;
  double scale;  ///< from what is stored to what people read
};
constexpr Quantity kTurntable{"turntable", "deg", 180.0 / kPi};
constexpr Quantity kTilt{"tilt", "deg", 180.0 / kPi};
constexpr Quantity kReach{"the arm's reach", "mm", 1};
constexpr Quantity kHeight{"the head's height", "mm", 1};
constexpr Quantity kStandoff{"the head's stand-off", "mm", 1};

std::string text_of(const Quantity& what, double value) {
  return fixed_text(value * what.scale, 2);
}

std::string text_of(const Quantity& what, const Range& range) {
  return text_of(what, range.low) + " to " + text_of(what, range.high) + " " + what.unit;
}

Status check(const Quantity& what, double value, const Range& range, double slack, const std::string& where) {
  if (range.contains(value, slack)) {  // false for what is no number
    return {};
  }
  return fail(ErrorKind::kUsage,
              std::string(what.name) + " " + text_of(what, value) + " " + what.unit + " is out of limits",
              where, "it goes from " + text_of(what, range));
}

Status narrow(const Quantity& what, Range& range, const std::optional<Range>& limit, double slack,
              const std::string& where) {
  if (!limit) {
    return {};
  }
  const Range both{std::max(range.low, limit->low), std::min(range.high, limit->high)};
  if (!(both.low <= both.high + slack)) {
    return bad_input(where,
                     std::string("the limits exclude every view: ") + what.name + " " +
                         text_of(what, *limit) + ", and the device goes from " + text_of(what, range),
                     "allow some of what the device can do");
  }
  range = {both.low, std::max(both.low, both.high)};
  return {};
}

}  // namespace

Result<Rig> narrowed(const Rig& rig, const RigLimits& limits, const std::string& where) {
  Rig out = rig;
  Status status;
  if (rig.has_turntable && rig.turns_fully()) {
    // Round and round: any part of the turn can be allowed, whatever angle it is counted from.
    const Range allowed = limits.turntable_rad.value_or(rig.turntable_rad);
    out.turntable_rad = allowed.high - allowed.low < kFullTurnRad ? allowed : rig.turntable_rad;
  } else if (rig.has_turntable) {
    status = narrow(kTurntable, out.turntable_rad, limits.turntable_rad, kSlackRad, where);
  }
  if (status) {
    Range tilt{rig.tilt_min_rad, rig.tilt_max_rad};
    status = narrow(kTilt, tilt, limits.tilt_rad, kSlackRad, where);
    out.tilt_min_rad = tilt.low;
    out.tilt_max_rad = tilt.high;
  }
  if (status && rig.robot) {
    status = narrow(kReach, out.robot->reach_mm, limits.reach_mm, kSlackMm, where);
    if (status) {
      status = narrow(kHeight, out.robot->height_mm, limits.height_mm, kSlackMm, where);
    }
    if (status) {
      status = narrow(kStandoff, out.robot->standoff_mm, limits.standoff_mm, kSlackMm, where);
    }
  }
  if (!status) {
    return std::unexpected(status.error());
  }
  out.hand_turns = rig.hand_turns && !limits.no_hand_turns;
  out.keep_out_margin_mm = std::max(rig.keep_out_margin_mm, limits.margin_mm.value_or(0.0));
  return out;
}

Status check_reach(const Rig& rig, const RigidTransform& stage_from_scanner, const std::string& where) {
  if (!rig.robot) {
    return fail(ErrorKind::kUsage, "this device has no arm that carries the scanner", where);
  }
  const std::optional<HeadBox> head = head_of(rig);
  const Eigen::Vector3d middle = stage_from_scanner * (head ? head->middle_mm() : Eigen::Vector3d(0, 0, 0));
  const RobotReach& arm = *rig.robot;
  Status status = check(kReach, (middle - arm.base_mm).norm(), arm.reach_mm, kSlackMm, where);
  if (status) {
    status = check(kHeight, middle.z() - rig.support_height_mm, arm.height_mm, kSlackMm, where);
  }
  return status ? check(kStandoff, middle.norm(), arm.standoff_mm, kSlackMm, where) : status;
}

Status check_limits(const Rig& rig, const Placement& placement, const std::string& where) {
  if (placement.hand_turn) {
    if (!placement.hand_turn->is_rigid()) {
      return fail(ErrorKind::kUsage, "the turn that was asked for is no rotation", where,
                  "give a rigid transform");
    }
    if (!rig.hand_turns) {
      return fail(ErrorKind::kUsage, "the tablet cannot be turned by hand on this rig", where,
                  "ask for a placement by motor");
    }
  }
  const Range tilt{rig.tilt_min_rad, rig.tilt_max_rad};
  if (placement.free_pose) {
    if (!placement.free_pose->is_rigid(1e-6) || placement.turntable_rad != 0 || placement.tilt_rad != 0) {
      return fail(ErrorKind::kUsage, "the pose that was asked for is no pose of an arm", where,
                  "give a rigid transform, and no turntable or tilt beside it");
    }
    if (Status status = check_reach(rig, *placement.free_pose, where); !status) {
      return status;
    }
    return check(kTilt, tilt_of(placement), tilt, kSlackRad, where);
  }
  if (rig.robot && !(placement.turntable_rad == 0 && placement.tilt_rad == 0)) {
    return fail(ErrorKind::kUsage, "an arm has neither turntable nor tilt", where, "ask for a free pose");
  }
  if (rig.robot) {
    return {};
  }
  if (!rig.has_turntable && placement.turntable_rad != 0.0) {
    return fail(ErrorKind::kUsage, "this device has no turntable", where);
  }
  if (Status status = check(kTilt, placement.tilt_rad, tilt, kSlackRad, where); !status) {
    return status;
  }
  if (!std::isfinite(placement.turntable_rad)) {
    return fail(ErrorKind::kUsage, "the turntable's angle is not a number", where);
  }
  const bool stops = rig.has_turntable && !rig.turns_fully();
  return stops ? check(kTurntable, placement.turntable_rad, rig.turntable_rad, kSlackRad, where) : Status{};
}

}  // namespace dubsar
