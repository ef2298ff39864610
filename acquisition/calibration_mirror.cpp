// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_mirror.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/calibration_volume.h"
#include "acquisition/mirror_axis.h"
#include "core/number_text.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kMostRad = rad_from_deg(15);
constexpr double kStepRad = rad_from_deg(0.25);
constexpr int kAtOnce = 12;      // poses: four at each of three positions
constexpr int kEnoughEach = 12;  // more at one position tell little
constexpr double kWholeWay = 0.85;

/// Whether the stripe on a board in the middle part of the volume, held in the middle column (of a stripe
/// that runs down: row), is in the picture.
bool is_seen(const RigCalibration& rig, double mirror) {
  const Plane plane = rig.motion.laser_at(rig.laser, mirror);
  const bool down = runs_down(rig.laser);
  // The mirror moves the stripe across itself.
  const Eigen::Vector3d way = down ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const double margin_px = 0.05 * (down ? rig.camera.width : rig.camera.height);
  for (const double part : {-0.2, 0.0, 0.2}) {
    const Eigen::Vector3d middle(0, 0, rig.working_distance_mm + part * rig.depth_range_mm);
    // Where the plane crosses that depth.
    const auto t = plane.along(middle, way);
    if (t && rig.camera.sees(rig.camera.project(middle + *t * way), margin_px)) {
      return true;
    }
  }
  return false;
}

double reach(const RigCalibration& rig, double sign) {
  double out = 0;
  while (out + kStepRad <= kMostRad && is_seen(rig, sign * (out + kStepRad))) {
    out += kStepRad;
  }
  return sign * out;
}

}  // namespace

double mirror_axis_doubt_rad(const RigCalibration& rig, double sigma_rad) {
  const double lean = std::asin(std::clamp(rig.motion.direction.dot(rig.laser.normal), -1.0, 1.0));
  return std::hypot(sigma_rad, lean);
}

double mirror_axis_sigma_mm(const RigCalibration& rig, double doubt_rad) {
  const double way = std::max(reach(rig, 1), -reach(rig, -1));
  const double half_field =
      0.5 * (runs_down(rig.laser) ? rig.camera.height : rig.camera.width) * rig.field_per_px_mm();
  return half_field * std::min(doubt_rad, rad_from_deg(90)) * (1 - std::cos(way));
}

std::optional<MirrorAdvice> missing_mirror_poses(const std::vector<CalibrationView>& views,
                                                 const Intrinsics& intrinsics, const RigCalibration& rig,
                                                 double doubt_rad, double wanted_rad) {
  if (doubt_rad <= wanted_rad) {
    return std::nullopt;
  }
  MirrorAdvice out;
  out.from = reach(rig, -1);
  out.to = reach(rig, 1);
  const double middle = 0.5 * (out.from + out.to);
  const double swing = 0.5 * (out.to - out.from);
  std::array<int, 3> shown{};  // at the low end, in the middle, at the high end
  for (const std::size_t i : intrinsics.used) {
    const double part = swing > 0 ? (views[i].mirror_position - middle) / swing : 0;
    shown[0] += part < -kWholeWay ? 1 : 0;
    shown[1] += std::abs(part) < 1 - kWholeWay ? 1 : 0;
    shown[2] += part > kWholeWay ? 1 : 0;
  }
  if (*std::ranges::min_element(shown) >= kEnoughEach) {
    return std::nullopt;
  }
  out.poses = kAtOnce;
  const auto deg = [](double rad) { return number_text(std::round(10 * deg_from_rad(rad)) / 10); };
  out.say = "let the mirror go from " + deg(out.from) + "° to " + deg(out.to) +
            "°, as far as the stripe stays in the picture, and show the board where the stripe is: " +
            std::to_string(out.poses) +
            " poses, by turns at both ends and in the middle (the axis is known to " + deg(doubt_rad) +
            "°, " + deg(wanted_rad) + "° are wanted)";
  return out;
}

}  // namespace dubsar
