// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "acquisition/calibration_joint.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/calibration_stage.h"
#include "acquisition/mirror_axis.h"
#include "core/number_text.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr const char* kMoreStripe = "show the stripe on the board near and far, left and right";

std::string rounded(double value) {
  return number_text(std::round(value * 100) / 100);
}

/// Takes samples that the first plane fit called outliers out of the joint refinement.
std::vector<StripeSample> inliers(const std::vector<StripeSample>& samples,
                                  const std::vector<std::uint8_t>& keep) {
  std::vector<StripeSample> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (keep[i] != 0) {
      out.push_back(samples[i]);
    }
  }
  return out;
}

/// Laser and stage as they can be told without any refinement.
Status first_values(const std::vector<CalibrationView>& views, const Intrinsics& intrinsics,
                    const CalibrationOptions& options, std::vector<StripeSample>& stripes,
                    JointState& state) {
  const bool galvanometer = options.motion == MotionKind::kGalvanometer;
  if (galvanometer) {
    const Result<MirrorFit> mirror = mirror_from_stripes(views, intrinsics, stripes);
    if (!mirror) {
      return std::unexpected(mirror.error());
    }
    state.motion = mirror->motion;
    state.laser = mirror->laser;
    state.has_laser = true;
    state.has_stage = true;
    std::erase_if(stripes, [&](const StripeSample& sample) {
      const double position = views[intrinsics.used[sample.view]].mirror_position;
      return std::abs(state.motion.laser_at(state.laser, position).signed_distance_mm(sample.point_mm)) > 1.0;
    });
    return {};
  }
  if (!stripes.empty()) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(stripes.size());
    for (const StripeSample& sample : stripes) {
      points.push_back(sample.point_mm);
    }
    const Result<PlaneFit> fit = fit_plane(points);
    if (!fit) {
      return std::unexpected(fit.error());
    }
    const auto kept = static_cast<std::size_t>(std::count(fit->inlier.begin(), fit->inlier.end(), 1));
    if (3 * kept < 2 * stripes.size()) {
      return bad_input(
          {}, "a third of the stripe does not lie in one plane",
          "see that neither laser nor camera was moved between the pictures, and that the board is flat");
    }
    state.laser = fit->plane;
    if (state.laser.distance_mm < 0) {
      state.laser = {-state.laser.normal, -state.laser.distance_mm};
    }
    state.has_laser = true;
    stripes = inliers(stripes, fit->inlier);
  }
  if (options.motion) {
    const Result<RigMotion> motion = stage_from_poses(*options.motion, views, intrinsics);
    if (!motion) {
      return std::unexpected(motion.error());
    }
    state.motion = *motion;
    state.has_stage = true;
  }
  return {};
}

/// How far a slide's millimetre is from one by the board, as a share.
double scale_off(const JointState& state) {
  return state.has_stage && state.motion.kind == MotionKind::kLinear
             ? std::abs(state.motion.direction.norm() - 1)
             : 0;
}

std::string stage_scale_line(const JointState& state) {
  return "1 mm of the stage is " + number_text(std::round(1e4 * state.motion.direction.norm()) / 1e4) +
         " mm by the board: either the size of the board is not the one that is named, or the stage's steps "
         "per millimetre are off";
}

/// Names the pictures of a laser that show no stripe that counts.
void tell_lost_stripes(const std::vector<CalibrationView>& views, const std::vector<std::size_t>& used,
                       const std::set<std::size_t>& with_stripe, std::vector<std::string>& left_out) {
  for (std::size_t k = 0; k < used.size(); ++k) {
    const CalibrationView& view = views[used[k]];
    if (!view.laser_picture.empty() && !with_stripe.contains(k)) {
      left_out.push_back(view.laser_picture + ": no stripe on the board that lies in the laser's plane");
    }
  }
}

std::unexpected<Error> bad_volume(double sigma_um, const std::string& mend) {
  return bad_input({}, "points would be known to " + rounded(sigma_um) + " µm only", mend);
}

/// Refuses what is worse than the limits, with the reason.
Status good_enough(const CalibrationOptions& options, const JointErrors& errors, const JointState& state) {
  const CameraModel& camera = state.camera;
  const auto refuse = [](const std::string& what, const char* mend) { return bad_input({}, what, mend); };
  // The stage first, for a board that slid on it spoils the corners of all boards together.
  if (errors.stage_rms_px > options.most_stage_px) {
    return refuse("the board on the stage is off by " + rounded(errors.stage_rms_px) +
                      " px from where the stage puts it, more than " + rounded(options.most_stage_px),
                  "see that the board lay still on the stage, and that its pictures are named with the right "
                  "positions");
  }
  if (errors.corner_rms_px > options.most_corner_px) {
    return refuse(
        "corners are off by " + rounded(errors.corner_rms_px) + " px, more than " +
            rounded(options.most_corner_px),
        "see that the board is flat, its size is the one named, and nothing moved while a picture was taken");
  }
  if (errors.focal_sigma_px > options.most_focal_share * camera.fx_px) {
    return refuse(
        "the focal length is known to " + rounded(100 * errors.focal_sigma_px / camera.fx_px) + " % only",
        "tilt the board by 25 to 40° to each side, and show it near and far");
  }
  if (errors.stripe_rms_px > options.most_stripe_px) {
    return refuse(
        "the stripe is off the laser plane by " + rounded(errors.stripe_rms_px) + " px, more than " +
            rounded(options.most_stripe_px),
        "see that neither laser nor camera was moved between the pictures, and that the board is flat");
  }
  if (scale_off(state) > options.most_stage_scale) {
    return refuse(stage_scale_line(state),
                  "measure the squares of the board, and see to the stage's steps per millimetre and to the "
                  "positions that its pictures are named with");
  }
  if (state.has_stage && state.motion.kind == MotionKind::kTurntable &&
      errors.axis_sigma_rad > options.most_turntable_axis_rad) {
    return refuse(
        "the turntable's axis is known to " + rounded(deg_from_rad(errors.axis_sigma_rad)) + "° only",
        "turn the board on the turntable as far to either side as the camera still sees it");
  }
  if (1e3 * errors.volume_sigma_mm > options.most_volume_sigma_um) {
    return bad_volume(1e3 * errors.volume_sigma_mm, kMoreStripe);
  }
  return {};
}

}  // namespace

Result<CalibrationReport> calibrate_rig(const std::vector<CalibrationView>& views,
                                        const CalibrationOptions& options) {
  Result<Intrinsics> intrinsics = find_intrinsics(views);
  if (!intrinsics) {
    return std::unexpected(intrinsics.error());
  }
  std::vector<StripeSample> stripes =
      stripe_samples(views, *intrinsics, options.board, options.plate_margin_mm);
  JointState state;
  state.camera = intrinsics->camera;
  state.camera_from_board = intrinsics->camera_from_board;
  if (Status first = first_values(views, *intrinsics, options, stripes, state); !first) {
    return std::unexpected(first.error());
  }
  const Result<JointErrors> errors =
      refine_jointly(views, intrinsics->used, stripes, options.depth_range_mm, state);
  if (!errors) {
    return std::unexpected(errors.error());
  }
  if (Status fine = good_enough(options, *errors, state); !fine) {
    return std::unexpected(fine.error());
  }
  CalibrationReport report;
  RigCalibration& rig = report.rig;
  rig.camera = state.camera;
  rig.depth_range_mm = options.depth_range_mm;
  double distance = 0;
  for (const RigidTransform& pose : state.camera_from_board) {
    const Eigen::Vector2d middle = 0.5 * (options.board.low_mm() + options.board.high_mm());
    distance += (pose * Eigen::Vector3d(middle.x(), middle.y(), 0)).z() /
                static_cast<double>(state.camera_from_board.size());
  }
  rig.working_distance_mm = distance;
  if (state.has_laser) {
    rig.laser = state.laser;
    rig.working_distance_mm =
        rig.laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()).value_or(distance);
  }
  rig.motion = state.motion;
  rig.has_laser = state.has_laser;
  rig.has_motion = state.has_stage;
  CalibrationQuality& quality = rig.quality;
  quality.board_views = static_cast<int>(intrinsics->used.size());
  std::set<std::size_t> with_stripe;
  for (const StripeSample& sample : stripes) {
    with_stripe.insert(sample.view);
  }
  quality.stripe_views = static_cast<int>(with_stripe.size());
  for (const std::size_t i : intrinsics->used) {
    quality.stage_positions += views[i].fixed.empty() ? 0 : 1;
  }
  quality.corner_rms_px = errors->corner_rms_px;
  quality.corner_rms_um = 1e3 * errors->corner_rms_px * distance / state.camera.fx_px;
  quality.stripe_rms_px = errors->stripe_rms_px;
  quality.stripe_rms_um = 1e3 * errors->stripe_rms_mm;
  quality.stage_rms_um = 1e3 * errors->stage_rms_mm;
  quality.focal_sigma_px = errors->focal_sigma_px;
  quality.volume_sigma_um = 1e3 * errors->volume_sigma_mm;
  quality.axis_sigma_rad = errors->axis_sigma_rad;
  quality.left_out = intrinsics->left_out;
  tell_lost_stripes(views, intrinsics->used, with_stripe, quality.left_out);
  intrinsics->camera = state.camera;
  intrinsics->camera_from_board = state.camera_from_board;
  report.missing = missing_poses(views, *intrinsics, options.board, state.has_laser ? &rig.laser : nullptr,
                                 options.plate_margin_mm, options.depth_range_mm);
  if (scale_off(state) > options.wanted_stage_scale) {
    report.missing.insert(report.missing.begin(), stage_scale_line(state));
  }
  if (options.motion == MotionKind::kGalvanometer) {
    quality.axis_sigma_rad = mirror_axis_doubt_rad(rig, errors->axis_sigma_rad);
    report.mirror =
        missing_mirror_poses(views, *intrinsics, rig, quality.axis_sigma_rad, options.wanted_mirror_axis_rad);
    quality.volume_sigma_um =
        std::hypot(quality.volume_sigma_um, 1e3 * mirror_axis_sigma_mm(rig, quality.axis_sigma_rad));
    if (quality.volume_sigma_um > options.most_volume_sigma_um) {
      return bad_volume(quality.volume_sigma_um, report.mirror ? report.mirror->say : kMoreStripe);
    }
    if (report.mirror) {
      report.missing.insert(report.missing.begin(), report.mirror->say);
    }
  }
  return report;
}

}  // namespace dubsar
