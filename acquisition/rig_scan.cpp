// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_scan.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "acquisition/camera_region.h"
#include "acquisition/fresh_frame.h"
#include "acquisition/rig_parts.h"
#include "acquisition/wall_clock.h"
#include "core/number_text.h"

namespace dubsar {

namespace {

constexpr const char* kRefused = "scan cancelled";  // by who takes the rows

StripeOptions stripe_options(const RigFile& file) {
  StripeOptions options;
  options.sigma_px = file.stripe_sigma_px;
  options.method = file.stripe_method == "centroid"   ? StripeMethod::kCentroid
                   : file.stripe_method == "gaussian" ? StripeMethod::kGaussian
                   : file.stripe_method == "steger"   ? StripeMethod::kSteger
                                                      : StripeMethod::kAdaptive;
  options.keep_light = options.method == StripeMethod::kAdaptive;
  options.axis = file.stripe_per_row ? StripeAxis::kPerRow : StripeAxis::kPerColumn;
  return options;
}

GrayView view_of(const Frame& frame) {
  return {frame.pixels.data(), static_cast<int>(frame.width), static_cast<int>(frame.height),
          frame.stride_bytes};
}

Status fits(const RigFile& file, const RigCalibration& calibration, const DeviceCapabilities& camera,
            const std::string& where) {
  if (!camera.yields_frames) {
    return fail(ErrorKind::kUsage, file.camera + " is no camera", where, "name a camera: see dubsar drivers");
  }
  if (!calibration.has_laser || !calibration.has_motion) {
    return bad_input(
        where, "the calibration knows no " + std::string(calibration.has_laser ? "stage" : "laser plane"),
        "calibrate with pictures of the laser and of the board on the stage");
  }
  if (!calibration.camera_serial.empty() && !camera.serial.empty() &&
      calibration.camera_serial != camera.serial) {
    return bad_input(
        where,
        "the calibration is of camera " + calibration.camera_serial + ", this is camera " + camera.serial,
        "name the calibration of this camera, or calibrate it");
  }
  return {};
}

}  // namespace

std::optional<double> days_since(const std::string& iso_8601) {
  std::tm parts{};
  const char* end = strptime(iso_8601.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  if (end == nullptr || *end != '\0') {
    return std::nullopt;
  }
  const double seconds = std::difftime(std::time(nullptr), timegm(&parts));
  constexpr double kClocksDifferS = 600;
  return seconds < -kClocksDifferS ? std::nullopt : std::optional(std::max(0.0, seconds / 86400));
}

RigScanner::RigScanner(const RigFile& file, const RigCalibration& calibration, Device camera, Device stage,
                       StripeAxis axis)
    : file_(file),
      camera_(std::move(camera)),
      stage_(std::move(stage)),
      triangulator_(std::make_unique<Triangulator>(calibration, axis)),
      extractor_(stripe_options(file)),
      stopped_(std::make_unique<std::atomic<bool>>(false)) {}

Result<RigScanner> RigScanner::make(const RigFile& file, const RigCalibration& calibration, Device camera,
                                    Device stage, const std::string& where) {
  const Result<DeviceCapabilities> of_camera = camera.capabilities();
  if (!of_camera) {
    return std::unexpected(of_camera.error());
  }
  if (Status status = fits(file, calibration, *of_camera, where); !status) {
    return std::unexpected(status.error());
  }
  const MotionKind kind = calibration.motion.kind;
  if (Status unit = check_unit(file, kind, where); !unit) {
    return std::unexpected(unit.error());
  }
  const Result<StageAxis> axis = axis_for_scan(file, stage, kind, where);
  if (!axis) {
    return std::unexpected(axis.error());
  }
  if (Status zero = check_zero(*axis, stage, kind, where); !zero) {
    return std::unexpected(zero.error());
  }
  if (Status turn = check_turn(file, kind, where); !turn) {
    return std::unexpected(turn.error());
  }
  const Result<RigCalibration> seen =
      file.region ? seen_in(*file.region, calibration, where) : Result<RigCalibration>(calibration);
  if (!seen) {
    return std::unexpected(seen.error());
  }
  // How fast a camera is goes by its region.
  Status status = file.region ? put_region(*file.region, camera, where) : Status{};
  status = status ? put_camera_settings(file, camera, where) : status;
  if (!status) {
    return std::unexpected(status.error());
  }
  RigScanner out(file, *seen, std::move(camera), std::move(stage),
                 file.stripe_per_row ? StripeAxis::kPerRow : StripeAxis::kPerColumn);
  out.axis_ = *axis;
  Rig& rig = out.rig_;
  rig.name = file.name;
  const bool turns_tablet = calibration.motion.kind == MotionKind::kTurntable;
  rig.view = calibration.view(file.step, turns_tablet ? 0.5 * (file.start + end_of(file)) : 0.0);
  rig.view.motion_per_row_mm = Eigen::Vector3d::Zero();  // positions are those of the middle row
  rig.field_x_mm = field_mm(*seen, file.stripe_per_row);
  const double row_spacing_mm = calibration.row_spacing_mm(file.step);
  rig.field_y_mm = row_spacing_mm * (file.rows - 1);
  rig.spacing_mm = std::max(calibration.field_per_px_mm(), row_spacing_mm);
  rig.depth_range_mm = depth_mm(*seen);
  rig.hand_turns = file.hand_turns;
  rig.support_height_mm = file.support_height_mm;
  rig.head = file.head;
  rig.calibration =
      file.calibration + ", made " + calibration.made_at +
      (calibration.temperature_c ? " at " + number_text(*calibration.temperature_c) + " °C" : std::string());
  rig.calibration_age_days = days_since(calibration.made_at);
  out.device_id_ = file.name + (of_camera->serial.empty() ? std::string() : ", camera " + of_camera->serial);
  return out;
}

Status RigScanner::check_frame(const Frame& frame) const {
  const CameraModel& camera = triangulator_->calibration().camera;
  const PictureRegion asked = file_.region.value_or(PictureRegion{0, 0, camera.width, camera.height});
  if (static_cast<int>(frame.width) != asked.width || static_cast<int>(frame.height) != asked.height ||
      static_cast<int>(frame.offset_x) != asked.x || static_cast<int>(frame.offset_y) != asked.y) {
    const auto region = [](auto width, auto height, auto x, auto y) {
      return std::to_string(width) + " x " + std::to_string(height) + " pixels from " + std::to_string(x) +
             ", " + std::to_string(y) + " on";
    };
    return bad_input(file_.camera,
                     "the camera sends " + region(frame.width, frame.height, frame.offset_x, frame.offset_y) +
                         (file_.region ? ", the rig asks for " : ", it was calibrated with ") +
                         region(asked.width, asked.height, asked.x, asked.y),
                     file_.region
                         ? "leave the region to region_px of the rig"
                         : "ask for the picture that was calibrated (?size= of v4l2:, camera_settings "
                           "of aravis:), or for a part of it with region_px of the rig");
  }
  if (frame.format != PixelFormat::kMono8) {
    return bad_input(file_.camera, "the camera sends more than eight bits a pixel",
                     "ask for eight: ?format=GREY of v4l2:, ?format=Mono8 of aravis:");
  }
  return {};
}

Status RigScanner::approach() {
  const double from = travel_of(file_, axis_, 0).from;
  const Status may = unless_stopped(*stopped_, file_);
  return may && from < file_.start
             ? stage_.move({static_cast<std::uint32_t>(file_.axis), from, file_.speed, false})
             : may;
}

Status RigScanner::row(int number, ProfileSink& sink, ScanTally& tally) {
  const double position = row_position(file_, axis_, number);
  const auto laser = static_cast<std::uint32_t>(file_.laser);
  if (Status moved = stage_.move({static_cast<std::uint32_t>(file_.axis), position, file_.speed, false});
      !moved) {
    return moved;
  }
  const auto take = [&](double power) -> Result<Frame> {
    if (Status may = unless_stopped(*stopped_, file_); !may) {
      return std::unexpected(may.error());
    }
    if (Status lit = stage_.set_laser(laser, power); !lit) {
      return std::unexpected(lit.error());
    }
    Result<Frame> frame = fresh_frame(camera_, [this] { return stopped_->load(); });
    const Status fits = frame ? check_frame(*frame) : Status{};
    return fits ? std::move(frame) : std::unexpected(fits.error());
  };
  if (file_.ambient) {
    const Result<Frame> dark = take(0);
    if (!dark) {
      return std::unexpected(dark.error());
    }
    dark_ = gray_of(*dark);
  }
  const Result<Frame> lit = take(file_.laser_power);
  if (!lit) {
    return std::unexpected(lit.error());
  }
  const Result<double> there = position_of(stage_, static_cast<std::size_t>(file_.axis));
  if (!there) {
    return std::unexpected(there.error());
  }
  if (std::abs(*there - position) > 0.5 * file_.step) {
    const bool rotary = triangulator_->calibration().motion.kind != MotionKind::kLinear;
    return fail(ErrorKind::kDevice,
                "the stage is not where it was sent: at " + position_text(rotary, *there) + ", not " +
                    position_text(rotary, position),
                file_.stage, "see whether something blocks it, and home it");
  }
  SweptRow seen{number, lit->timestamp_ns, *there, {}};
  extractor_.extract(view_of(*lit), file_.ambient ? dark_.view() : GrayView{}, seen.stripe);
  return hand_on(std::move(seen), sink, tally);
}

RowWindow::Give RigScanner::giving(ProfileSink& sink, ScanTally& tally) const {
  return [this, &sink, &tally](const Profile& profile) -> Status {
    ++tally.profiles_sent;
    return sink.profile(profile) ? Status{} : fail(ErrorKind::kCancelled, kRefused, file_.name);
  };
}

Status RigScanner::begin(ProfileSink& sink, ScanTally& tally) {
  const RigCalibration& calibration = triangulator_->calibration();
  const double pitch = pitch_->value();
  ScanInfo info;
  info.cols = triangulator_->samples_per_profile();
  info.expected_rows = file_.rows;
  // On a turntable it goes by how far from the axis the clay is: by the grid's own samples.
  const bool turns_tablet = calibration.motion.kind == MotionKind::kTurntable;
  info.spacing_mm =
      turns_tablet ? 0 : std::max(calibration.field_per_px_mm(), calibration.row_spacing_mm(pitch));
  info.view = calibration.view(pitch, calibration.motion.view_position(file_.start, end_of(file_)));
  info.timestamp_ns = began_ns_;
  info.device = device_id_;
  window_ = std::make_unique<RowWindow>(*triangulator_, extractor_.options(), pitch);
  if (!sink.begin(info)) {
    return fail(ErrorKind::kCancelled, kRefused, file_.name);
  }
  for (SweptRow& row : std::exchange(waiting_, {})) {
    if (Status handed = hand_on(std::move(row), sink, tally); !handed) {
      return handed;
    }
  }
  return {};
}

Status RigScanner::hand_on(SweptRow row, ProfileSink& sink, ScanTally& tally) {
  return window_->take(std::move(row), giving(sink, tally));
}

Status RigScanner::scan(ProfileSink& sink) {
  stopped_->store(false);
  if (Status homed = home_once(stage_, file_.axis, [this] { return unless_stopped(*stopped_, file_); });
      !homed) {
    return homed;
  }
  LaserGuard dark(stage_, static_cast<std::uint32_t>(file_.laser));
  Result<Travel> plan = Travel{};
  if (file_.continuous) {
    plan = plan_sweep();
    if (!plan) {
      return std::unexpected(plan.error());
    }
  }
  if (Status started = camera_.start_frames(); !started) {
    return started;
  }
  const StreamGuard stream(camera_);
  ScanTally tally;
  window_.reset();
  waiting_.clear();
  began_ns_ = wall_clock_ns();
  pitch_.emplace(file_.step, plan->speed, triangulator_->calibration().motion.kind != MotionKind::kLinear);
  Status status = file_.continuous ? sweep(*plan, sink, tally) : begin(sink, tally);
  if (status && !file_.continuous) {
    status = approach();
  }
  for (int number = 0; status && !file_.continuous && number < file_.rows; ++number) {
    status = unless_stopped(*stopped_, file_);
    status = status ? row(number, sink, tally) : status;
  }
  if (!status) {
    [[maybe_unused]] const Status said = stage_.stop();
  }
  if (!window_) {  // it ended before anybody knew how far apart its rows come
    const Status begun = begin(sink, tally);
    status = status ? begun : status;
  }
  // Whatever ended the scan, rows that wait for neighbours are kept, unless nobody wants them.
  if (status || status.error().what != kRefused) {
    const Status rest = window_->finish(giving(sink, tally));
    status = status ? rest : status;
  }
  if (const auto remark = pitch_->remark()) {
    sink.remark(*remark);
  }
  status = dark.off(std::move(status));
  sink.end(tally);
  return status;
}

Status RigScanner::start_view() {
  if (Status started = camera_.start_frames(); !started) {
    return started;
  }
  Status lit = light_view(true);
  if (lit) {
    return lit;
  }
  [[maybe_unused]] const Status said = camera_.stop_frames();
  // It may have heard and not answered, and nobody ends a view that did not begin.
  return LaserGuard(stage_, static_cast<std::uint32_t>(file_.laser)).off(std::move(lit));
}

Status RigScanner::stop_view() {
  Status dark = light_view(false);
  const Status stopped = camera_.stop_frames();
  return dark ? stopped : dark;
}

Status RigScanner::light_view(bool lit) {
  const auto laser = static_cast<std::uint32_t>(file_.laser);
  return lit ? stage_.set_laser(laser, file_.laser_power) : put_off(stage_, laser);
}

Status RigScanner::stop() {
  stopped_->store(true);
  return stage_.stop();
}

Status RigScanner::halt() {
  stopped_->store(true);
  return stage_.emergency_stop();
}

}  // namespace dubsar
