// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/live_calibration.h"

#include <algorithm>
#include <utility>

#include "acquisition/calibration_folder.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/rig_parts.h"
#include "acquisition/stops_when_cancelled.h"
#include "formats/atomic_file.h"
#include "formats/make_folder.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr double kRunUp = 0.05;         // of the stage's way, before its first stop
constexpr std::size_t kFirstPoses = 4;  // before a camera can be told at all

/// Where one kind of picture has an exposure of its own, the other keeps that which the camera stands at.
Status complete_exposures(LiveCalibrationPlan& plan, const Device& camera) {
  if (plan.board_exposure_us.has_value() == plan.laser_exposure_us.has_value()) {
    return {};
  }
  const Result<SettingValue> stands = camera.get("exposure_us");
  if (!stands) {
    return std::unexpected(stands.error());
  }
  const auto* const whole = std::get_if<std::int64_t>(&*stands);
  const auto* const number = std::get_if<double>(&*stands);
  if (whole != nullptr || number != nullptr) {
    const double us = whole != nullptr ? static_cast<double>(*whole) : *number;
    plan.board_exposure_us = plan.board_exposure_us.value_or(us);
    plan.laser_exposure_us = plan.laser_exposure_us.value_or(us);
    return {};
  }
  return fail(ErrorKind::kUsage, "the camera does not tell its exposure", camera.uri(),
              "give --board-exposure and --laser-exposure, both");
}

}  // namespace

LiveCalibration::LiveCalibration(LiveCalibrationPlan plan, BoardSpec board, Device camera, Device stage)
    : plan_(std::move(plan)), board_(board), camera_(std::move(camera)), stage_(std::move(stage)) {}

Result<LiveCalibration> LiveCalibration::start(const LiveCalibrationPlan& given, Device camera, Device stage,
                                               const JobContext& job) {
  LiveCalibrationPlan plan = given;
  const Result<BoardSpec> board = parse_board(plan.set.board);
  if (!board) {
    return std::unexpected(board.error());
  }
  const Result<DeviceCapabilities> capable = camera.capabilities();
  if (!capable) {
    return std::unexpected(capable.error());
  }
  if (!capable->yields_frames) {
    return fail(ErrorKind::kUsage, "it is no camera that yields pictures", camera.uri(),
                "name a camera: see dubsar drivers");
  }
  RigFile way;
  way.camera = camera.uri();
  way.stage = stage.uri();
  way.axis = plan.axis;
  way.start = plan.from;
  way.step = plan.to - plan.from;
  way.rows = 2;
  double before = plan.from;
  if (plan.set.motion) {
    const Result<StageAxis> axis = axis_for_scan(way, stage, *plan.set.motion, stage.uri());
    if (!axis) {
      return std::unexpected(axis.error());
    }
    if (!axis->endless) {  // the last row of a scan may round beyond its limit
      plan.from = std::clamp(plan.from, axis->minimum, axis->maximum);
      plan.to = std::clamp(plan.to, axis->minimum, axis->maximum);
    }
    before = plan.from - kRunUp * (plan.to - plan.from);
    before = axis->endless ? before : std::max(before, axis->minimum);
    if (Status zero = check_zero(*axis, stage, *plan.set.motion, stage.uri()); !zero) {
      return std::unexpected(zero.error());
    }
    StopsWhenCancelled watch(stage, job);
    const Status homed = home_once(stage, plan.axis);
    if (auto refused = watch.refused()) {
      return std::unexpected(std::move(*refused));
    }
    if (!homed) {
      return std::unexpected(homed.error());
    }
  }
  plan.set.camera_serial = capable->serial;
  plan.set.depth_range_mm = plan.depth_range_mm.value_or(plan.set.depth_range_mm);
  plan.set.plate_margin_mm = plan.plate_margin_mm.value_or(plan.set.plate_margin_mm);
  if (Status whole = complete_exposures(plan, camera); !whole) {
    return std::unexpected(whole.error());
  }
  if (const Status made = make_folder(plan.folder); !made) {
    return std::unexpected(made.error());
  }
  LiveCalibration out(std::move(plan), *board, std::move(camera), std::move(stage));
  out.before_ = before;
  const fs::path list = out.plan_.folder / "calibration.toml";
  if (std::error_code ignored; !fs::exists(list, ignored)) {
    return out;
  }
  const Result<std::string> text = read_whole_file(list);
  const Result<CalibrationSet> had =
      text ? parse_calibration_set(*text, list.string()) : std::unexpected(text.error());
  if (!had) {
    return std::unexpected(had.error());
  }
  if (had->board != out.plan_.set.board || had->motion != out.plan_.set.motion ||
      had->camera_serial != out.plan_.set.camera_serial) {
    return bad_input(list.string(), "these pictures are of another board, stage or camera",
                     "take the new ones to an empty folder");
  }
  CalibrationSet set = *had;
  set.depth_range_mm = out.plan_.depth_range_mm.value_or(had->depth_range_mm);
  set.plate_margin_mm = out.plan_.plate_margin_mm.value_or(had->plate_margin_mm);
  set.stripe_sigma_px = out.plan_.set.stripe_sigma_px;  // the rig's file tells these
  set.stripe_per_row = out.plan_.set.stripe_per_row;
  const Result<CalibrationPictures> pictures = look_at_pictures(out.plan_.folder, set, job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  out.plan_.set = std::move(set);
  out.views_ = pictures->views;
  return out;
}

Status LiveCalibration::keep() const {
  return write_file_atomically(plan_.folder / "calibration.toml", calibration_set_to_toml(plan_.set));
}

CalibrationOptions LiveCalibration::options() const {
  CalibrationOptions out;
  out.board = board_;
  out.motion = plan_.set.motion;
  out.depth_range_mm = plan_.set.depth_range_mm;
  out.plate_margin_mm = plan_.set.plate_margin_mm;
  return out;
}

Result<CalibrationReport> LiveCalibration::calibrate() const {
  Result<CalibrationReport> report = calibrate_rig(views_, options());
  if (report) {
    report->rig.camera_serial = plan_.set.camera_serial;
    report->rig.temperature_c = plan_.set.temperature_c;
    report->rig.note = plan_.set.note;
  }
  return report;
}

std::vector<std::string> LiveCalibration::next() const {
  std::vector<std::string> out;
  if (plan_.set.poses.size() < kFirstPoses) {
    constexpr const char* kFirst[] = {
        "hold the board in the middle of the picture, the laser across it, its right side nearer by 30°",
        "the same with its left side nearer", "the same with its lower side nearer",
        "the same with its upper side nearer"};
    out.emplace_back(kFirst[plan_.set.poses.size()]);
    return out;
  }
  const Result<Intrinsics> intrinsics = find_intrinsics(views_);
  if (!intrinsics) {
    out.push_back(intrinsics.error().mend.empty() ? intrinsics.error().what : intrinsics.error().mend);
    return out;
  }
  std::vector<Eigen::Vector3d> points;
  for (const StripeSample& sample : stripe_samples(views_, *intrinsics, board_, plan_.set.plate_margin_mm)) {
    points.push_back(sample.point_mm);
  }
  const Result<PlaneFit> laser = fit_plane(points);
  if (!laser) {
    out.emplace_back("show the laser on the board");
  }
  for (std::string& one : missing_poses(views_, *intrinsics, board_, laser ? &laser->plane : nullptr,
                                        plan_.set.plate_margin_mm, plan_.set.depth_range_mm)) {
    out.push_back(std::move(one));
  }
  const bool carries = plan_.set.motion && *plan_.set.motion != MotionKind::kGalvanometer;
  if (carries && plan_.set.stops.empty()) {
    out.emplace_back("lay the board on the stage and let it go to its stops");
  }
  if (out.empty()) {
    // Nothing is missing by rule; whether it is enough, only the whole can tell.
    const Result<CalibrationReport> report = calibrate();
    if (!report) {
      out.push_back(report.error().mend.empty() ? report.error().what
                                                : report.error().what + "; " + report.error().mend);
    } else {
      out = report->missing;
    }
  }
  return out;
}

}  // namespace dubsar
