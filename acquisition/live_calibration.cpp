// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/live_calibration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "acquisition/calibration_folder.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/fresh_frame.h"
#include "acquisition/rig_parts.h"
#include "acquisition/stops_when_cancelled.h"
#include "core/number_text.h"
#include "core/order_statistics.h"
#include "formats/atomic_file.h"
#include "formats/gray_file.h"
#include "formats/make_folder.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr double kMovedPx = 0.5;  // corners of a board that was held still stay within this
constexpr int kLeastStops = 3;
constexpr double kRunUp = 0.05;         // of the stage's way, before its first stop
constexpr std::size_t kFirstPoses = 4;  // before a camera can be told at all

/// How far the corners that both have lie apart, the median; nothing without such corners.
std::optional<double> moved_px(const BoardView& a, const BoardView& b) {
  std::vector<double> ways;
  for (std::size_t i = 0; i < a.corners_mm.size(); ++i) {
    for (std::size_t k = 0; k < b.corners_mm.size(); ++k) {
      if ((a.corners_mm[i] - b.corners_mm[k]).norm() < 1e-6) {
        ways.push_back((a.corners_px[i] - b.corners_px[k]).norm());
      }
    }
  }
  if (ways.empty()) {
    return std::nullopt;
  }
  return median_of(std::move(ways));
}

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

Status LiveCalibration::expose(const std::optional<double>& exposure_us) {
  return exposure_us ? camera_.set("exposure_us", *exposure_us) : Status{};
}

Result<GrayImage> LiveCalibration::picture(bool laser, const std::optional<double>& exposure_us,
                                           const JobContext& job) {
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "calibration cancelled", plan_.folder.string());
  }
  if (Status exposed = expose(exposure_us); !exposed) {
    return std::unexpected(exposed.error());
  }
  const auto number = static_cast<std::uint32_t>(plan_.laser);
  if (Status lit = stage_.set_laser(number, laser ? plan_.laser_power : 0); !lit) {
    return std::unexpected(lit.error());
  }
  const Result<Frame> frame = fresh_frame(camera_, [&job] { return job.cancelled(); });
  if (!frame) {
    return std::unexpected(frame.error());
  }
  if (frame->offset_x != 0 || frame->offset_y != 0) {
    return bad_input(camera_.uri(),
                     "the camera sends a region that begins at pixel " + std::to_string(frame->offset_x) +
                         ", " + std::to_string(frame->offset_y),
                     "a rig is calibrated with a picture from 0, 0 on, of which it may scan a part "
                     "(region_px): set the camera's offsets to 0");
  }
  return gray_of(*frame);
}

Result<LiveCalibration::Taken> LiveCalibration::take_pose(const JobContext& job) {
  if (Status started = camera_.start_frames(); !started) {
    return std::unexpected(started.error());
  }
  const StreamGuard stream(camera_);
  LaserGuard dark(stage_, static_cast<std::uint32_t>(plan_.laser));
  StopsWhenCancelled watch(stage_, job);
  Result<Taken> taken = pose_while_streaming(job);
  const Status off = dark.off(taken ? Status{} : std::unexpected(taken.error()));
  if (auto refused = watch.refused()) {
    return std::unexpected(std::move(*refused));
  }
  return off ? std::move(taken) : std::unexpected(off.error());
}

Result<LiveCalibration::Taken> LiveCalibration::pose_while_streaming(const JobContext& job) {
  const std::size_t number = plan_.set.poses.size();
  CalibrationView view;
  if (plan_.set.motion == MotionKind::kGalvanometer) {
    // A third of the poses each, so that the axis shows; where its own steps take it, as a scan says it.
    const double mirror = std::lerp(plan_.from, plan_.to, 0.5 * static_cast<double>(number % 3));
    if (Status moved = stage_.move({static_cast<std::uint32_t>(plan_.axis), mirror, plan_.speed, false});
        !moved) {
      return std::unexpected(moved.error());
    }
    const Result<double> there = position_of(stage_, static_cast<std::size_t>(plan_.axis));
    if (!there) {
      return std::unexpected(there.error());
    }
    view.mirror_position = *there;
  }
  const Result<GrayImage> board = picture(false, plan_.board_exposure_us, job);
  if (!board) {
    return std::unexpected(board.error());
  }
  const std::size_t free = free_picture_number(plan_.folder, "pose", number);
  CalibrationSet::Pose names{numbered_picture("pose", free, ""), numbered_picture("pose", free, "_laser"),
                             numbered_picture("pose", free, "_dark"), view.mirror_position};
  Result<BoardView> seen = find_board(board->view(), board_, names.board);
  if (!seen) {
    return Taken{false, seen.error().what};
  }
  const Result<GrayImage> lit = picture(true, plan_.laser_exposure_us, job);
  const Result<GrayImage> dim = lit ? picture(false, plan_.laser_exposure_us, job) : lit;
  const Result<GrayImage> again = dim ? picture(false, plan_.board_exposure_us, job) : dim;
  if (!again) {
    return std::unexpected(again.error());
  }
  const Result<BoardView> later = find_board(again->view(), board_, names.board);
  const std::optional<double> moved = later ? moved_px(*seen, *later) : std::nullopt;
  if (!moved || *moved > kMovedPx) {
    return Taken{false, "the board moved by " + fixed_text(moved.value_or(99), 1) +
                            " px while the pictures were taken"};
  }
  for (const auto& [file, image] :
       {std::pair(&names.board, &*board), std::pair(&names.laser, &*lit), std::pair(&names.dark, &*dim)}) {
    if (Status written = write_gray_png(*image, plan_.folder / *file); !written) {
      return std::unexpected(written.error());
    }
  }
  view.board = std::move(*seen);
  view.laser_picture = names.laser;
  view.stripe_px = stripe_on_board(plan_.set, lit->view(), dim->view());
  plan_.set.poses.push_back(names);
  if (Status kept = keep(); !kept) {
    return std::unexpected(kept.error());
  }
  Taken out{true, std::to_string(view.board.corners_px.size()) + " of " +
                      std::to_string(board_.corner_count()) + " corners, " +
                      std::to_string(view.stripe_px.size()) + " points of the stripe"};
  views_.push_back(std::move(view));
  return out;
}

Result<LiveCalibration::Taken> LiveCalibration::take_stops(const JobContext& job) {
  if (!plan_.set.motion || *plan_.set.motion == MotionKind::kGalvanometer) {
    return fail(ErrorKind::kUsage, "nothing is carried by this stage", stage_.uri(),
                "say --motion linear or turntable, for a stage that moves camera or tablet");
  }
  if (Status started = camera_.start_frames(); !started) {
    return std::unexpected(started.error());
  }
  const StreamGuard stream(camera_);
  StopsWhenCancelled watch(stage_, job);
  Result<Taken> taken = stops_while_streaming(job);
  if (auto refused = watch.refused()) {
    return std::unexpected(std::move(*refused));
  }
  return taken;
}

Result<LiveCalibration::Taken> LiveCalibration::stops_while_streaming(const JobContext& job) {
  const auto axis = static_cast<std::uint32_t>(plan_.axis);
  constexpr std::string_view kLaid = "laid";
  int laid = 0;
  for (const CalibrationSet::Stop& had : plan_.set.stops) {  // some may have names that somebody wrote
    laid = had.fixed.starts_with(kLaid) ? std::max(laid, std::atoi(had.fixed.c_str() + kLaid.size())) : laid;
  }
  const std::string name = std::string(kLaid) + std::to_string(laid + 1);
  std::vector<CalibrationView> views;
  std::vector<CalibrationSet::Stop> stops;
  std::vector<GrayImage> pictures;
  std::size_t free = plan_.set.stops.size();
  if (Status moved = stage_.move({axis, before_, plan_.speed, false}); !moved) {
    return std::unexpected(moved.error());
  }
  for (int i = 0; i < plan_.stops; ++i) {
    job.progress("stage", static_cast<double>(i) / plan_.stops);
    const double share = static_cast<double>(i) / std::max(1, plan_.stops - 1);
    const double there = std::lerp(plan_.from, plan_.to, share);  // at the ends exactly there
    if (Status moved = stage_.move({axis, there, plan_.speed, false}); !moved) {
      return std::unexpected(moved.error());
    }
    const Result<double> position = position_of(stage_, axis);
    if (!position) {
      return std::unexpected(position.error());
    }
    Result<GrayImage> picture_now = picture(false, plan_.board_exposure_us, job);
    if (!picture_now) {
      return std::unexpected(picture_now.error());
    }
    free = free_picture_number(plan_.folder, "stage", free);
    CalibrationSet::Stop stop{numbered_picture("stage", free, ""), name, *position};
    Result<BoardView> seen = find_board(picture_now->view(), board_, stop.board);
    if (!seen) {
      continue;
    }
    CalibrationView view;
    view.board = std::move(*seen);
    view.fixed = name;
    view.stage_position = stop.position;
    views.push_back(std::move(view));
    stops.push_back(std::move(stop));
    ++free;
    pictures.push_back(std::move(*picture_now));
  }
  const std::string said =
      "seen at " + std::to_string(stops.size()) + " of " + std::to_string(plan_.stops) + " positions";
  if (static_cast<int>(stops.size()) < std::min(kLeastStops, plan_.stops)) {
    return Taken{false, said + ": lay the board so that it stays in the picture"};
  }
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (Status written = write_gray_png(pictures[i], plan_.folder / stops[i].board); !written) {
      return std::unexpected(written.error());
    }
    plan_.set.stops.push_back(stops[i]);
    views_.push_back(std::move(views[i]));
  }
  if (Status kept = keep(); !kept) {
    return std::unexpected(kept.error());
  }
  return Taken{true, said};
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
