// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/motor_placements.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/motion_limits.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// Straighter down than this, going round only rolls the view.
const double kStraightRad = rad_from_deg(1.0);

std::vector<double> steps_of(double low, double high, double step) {
  const int count = std::max(1, static_cast<int>(std::ceil((high - low) / step - 1e-9)));
  std::vector<double> out;
  for (int k = 0; k <= count; ++k) {
    out.push_back(high > low ? low + (high - low) * k / count : low);
    if (!(high > low)) {
      break;
    }
  }
  return out;
}

std::vector<double> turns_of(const Rig& rig, const Placement& now, double tilt_rad, const MotorSteps& steps) {
  if (!rig.has_turntable) {
    return {now.turntable_rad};
  }
  const bool straight = std::abs(tilt_rad) < kStraightRad;
  if (!rig.turns_fully()) {
    const double step = kFullTurnRad / (straight ? 4 : steps.turntable_steps);
    return steps_of(rig.turntable_rad.low, rig.turntable_rad.high, step);
  }
  const int turns = straight ? std::min(steps.turntable_steps, 4) : steps.turntable_steps;
  std::vector<double> out;
  for (int k = 0; k < turns; ++k) {
    out.push_back(2 * kPi * k / turns);
  }
  return out;
}

void add_arm_placements(const Rig& rig, double tilt_rad, const Eigen::Vector3d& focus_mm,
                        const MotorSteps& steps, std::vector<Placement>& out) {
  const double around = kFullTurnRad * std::sin(tilt_rad);
  const int bearings = std::max(1, static_cast<int>(std::ceil(around / rad_from_deg(steps.arm_step_deg))));
  for (int k = 0; k < (tilt_rad < kStraightRad ? 1 : bearings); ++k) {
    RigidTransform pose = stage_from_scanner(kFullTurnRad * k / bearings, tilt_rad, Eigen::Vector3d::Zero());
    pose.translation_mm = focus_mm;
    for (int roll = 0; roll < steps.arm_rolls; ++roll) {
      Placement placement;
      placement.free_pose = pose;
      placement.free_pose->rotation *=
          Eigen::AngleAxisd(kFullTurnRad * roll / steps.arm_rolls, Eigen::Vector3d::UnitZ())
              .toRotationMatrix();
      if (check_limits(rig, placement, {})) {
        out.push_back(std::move(placement));
      }
    }
  }
}

}  // namespace

std::vector<Placement> motor_placements(const Rig& rig, const Placement& now, const Eigen::Vector3d& focus_mm,
                                        const MotorSteps& steps) {
  std::vector<Placement> out;
  for (const double tilt : steps_of(rig.tilt_min_rad, rig.tilt_max_rad, rad_from_deg(steps.tilt_step_deg))) {
    if (rig.robot) {
      add_arm_placements(rig, tilt, focus_mm, steps, out);
      continue;
    }
    for (const double turn : turns_of(rig, now, tilt, steps)) {
      Placement placement;
      placement.turntable_rad = turn;
      placement.tilt_rad = tilt;
      out.push_back(placement);
    }
  }
  return out;
}

Result<Placement> first_placement(const Rig& rig, const StageScene& scene, const std::string& where) {
  Placement nearest;
  if (!rig.robot) {
    nearest.tilt_rad = std::clamp(0.0, rig.tilt_min_rad, rig.tilt_max_rad);
    const bool stops = rig.has_turntable && !rig.turns_fully();
    nearest.turntable_rad = stops ? std::clamp(0.0, rig.turntable_rad.low, rig.turntable_rad.high) : 0.0;
  }
  std::vector<Placement> all;
  if (!rig.robot) {
    all.push_back(nearest);
  }
  const std::vector<Placement> others = motor_placements(rig, nearest, scene.focus_mm, {});
  all.insert(all.end(), others.begin(), others.end());
  Status why;
  for (const Placement& placement : all) {
    const Status clear = check_clear(rig, scene, placement, where);
    if (clear) {
      return placement;
    }
    why = why ? clear : why;
  }
  const std::string because = why ? "no place that the arm reaches is within them" : why.error().what;
  return bad_input(where, "the limits exclude every view: " + because,
                   "allow some of what the device can do, or give the tablet's size");
}

std::string say_arm(const RigidTransform& stage_from_scanner, const Eigen::Matrix3d& stage_from_model,
                    const ModelFaces& faces) {
  const auto degrees = [](double rad) { return std::to_string(std::lround(deg_from_rad(rad)) % 360) + "°"; };
  const Eigen::Vector3d axis = stage_from_scanner.rotation.col(2);
  const double tilt = std::atan2(axis.head<2>().norm(), axis.z());
  // What is left when the axis is put upright by the shortest way: the turn about it.
  const Eigen::Matrix3d upright =
      Eigen::Quaterniond::FromTwoVectors(axis, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      stage_from_scanner.rotation;
  double roll = std::atan2(upright(1, 0), upright(0, 0));
  if (tilt < kStraightRad) {
    roll = roll < -1e-9 ? roll + kFullTurnRad : roll;
    return "arm straight above, rolled " + degrees(roll);
  }
  // Counted from the scanner's y axis pointing up the slope.
  roll -= std::atan2(axis.x(), -axis.y());
  roll = std::remainder(roll, kFullTurnRad);
  roll = roll < -1e-9 ? roll + kFullTurnRad : roll;
  const Eigen::Vector3d sideways(axis.x(), axis.y(), 0);
  Face side = Face::kObverse;
  double most = -1e9;
  for (int k = 0; k < kFaceCount; ++k) {
    const Face face = static_cast<Face>(k);
    const double towards = (stage_from_model * faces.normal(face)).dot(sideways);
    if (towards > most + 1e-9) {
      most = towards;
      side = face;
    }
  }
  return std::string("arm to the side of ") + spoken(side) + ", " + degrees(tilt) +
         " off the vertical, rolled " + degrees(std::max(0.0, roll));
}

}  // namespace dubsar
