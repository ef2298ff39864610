// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/range_rig.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "acquisition/placed_profiles.h"
#include "acquisition/stage_watch.h"

namespace dubsar {

RangeRig::RangeRig(const RigFile& file, Device camera, Device stage, StageAxis axis, std::string device_id)
    : file_(file),
      camera_(std::move(camera)),
      stage_(std::move(stage)),
      axis_(std::move(axis)),
      device_id_(std::move(device_id)),
      stopped_(std::make_unique<std::atomic<bool>>(false)) {}

Status RangeRig::check(const RigFile& file, const std::string& where) {
  if (!file.motion) {
    return bad_input(where, "nobody says how the stage moves the range camera",
                     "see [motion] in docs/formats/rig_toml.md");
  }
  if (file.speed <= 0) {
    return fail(ErrorKind::kUsage, "nobody says how fast the stage is to go", where,
                "give speed_mm_s or speed_deg_s: the camera's rate of profiles times the step");
  }
  if (Status unit = check_unit(file, file.motion->kind, where); !unit) {
    return unit;
  }
  return check_turn(file, file.motion->kind, where);
}

Result<RangeRig> RangeRig::make(const RigFile& file, Device camera, Device stage, const std::string& where) {
  const Result<DeviceCapabilities> of_camera = camera.capabilities();
  if (!of_camera) {
    return std::unexpected(of_camera.error());
  }
  if (!of_camera->yields_scans) {
    return fail(ErrorKind::kUsage, file.camera + " yields no profiles", where,
                "a camera that yields pictures needs a calibration");
  }
  if (Status said = check(file, where); !said) {
    return std::unexpected(said.error());
  }
  Result<StageAxis> axis = axis_for_scan(file, stage, file.motion->kind, where);
  if (!axis) {
    return std::unexpected(axis.error());
  }
  if (Status put = put_camera_settings(file, camera, where); !put) {
    return std::unexpected(put.error());
  }
  std::string id = file.name + (of_camera->serial.empty() ? std::string() : ", camera " + of_camera->serial);
  return RangeRig(file, std::move(camera), std::move(stage), std::move(*axis), std::move(id));
}

Status RangeRig::scan(ProfileSink& sink) {
  stopped_->store(false);
  if (Status homed = home_once(stage_, file_.axis, [this] { return unless_stopped(*stopped_, file_); });
      !homed) {
    return homed;
  }
  std::optional<LaserGuard> dark;  // goes last: a controller may take it for behind the move that still runs
  Status status = run(sink, dark);
  if (!status) {
    [[maybe_unused]] const Status said = stage_.stop();
  }
  return dark ? dark->off(std::move(status)) : status;
}

Status RangeRig::run(ProfileSink& sink, std::optional<LaserGuard>& dark) {
  const auto number = static_cast<std::uint32_t>(file_.axis);
  const PlacedProfiles::Scan scan{*file_.motion, file_.start, file_.step,
                                  file_.rows,    device_id_,  file_.speed};
  const Travel travel = travel_of(file_, axis_, file_.speed);
  Status there = unless_stopped(*stopped_, file_);
  there = there ? stage_.move({number, travel.from, file_.speed, false}) : there;
  if (!there) {
    return there;
  }
  const Result<StageReading> now = stage_.motion();
  if (!now) {
    return std::unexpected(now.error());
  }
  if (Status reports = check_reports(*now, file_); !reports) {
    return reports;
  }
  if (Status may = unless_stopped(*stopped_, file_); !may) {
    return may;
  }
  const auto laser = static_cast<std::size_t>(file_.laser);
  if (laser < now->laser.size()) {
    dark.emplace(stage_, static_cast<std::uint32_t>(laser));
    if (Status lit = stage_.set_laser(static_cast<std::uint32_t>(laser), file_.laser_power); !lit) {
      return lit;
    }
  }
  Status off = unless_stopped(*stopped_, file_);
  off = off ? stage_.move({number, travel.to, travel.speed, true}) : off;
  if (!off) {
    return off;
  }
  StageWatch watch(stage_, number, travel.time_of_way());
  PlacedProfiles placed(sink, watch.track(), scan);
  const Result<ScanOutcome> done = camera_.scan(placed);
  placed.flush();
  Status status;
  if (stopped_->load() || placed.cancelled()) {
    status = fail(ErrorKind::kCancelled, "scan cancelled", file_.name);
  } else if (placed.timeless()) {
    status = fail(ErrorKind::kDevice, "the camera does not tell when its profiles were taken", file_.camera,
                  "nothing else tells where the stage was: use a camera whose driver tells their times");
  } else if (placed.complete()) {
    watch.track().wait_closed(travel.time_to_rest(scan.end()));
    status = watch.finish();
    if (status && placed.tally().profiles_sent == 0) {
      status = fail(ErrorKind::kDevice, "nobody knows where the stage was: its answers come too late",
                    file_.stage, "relieve this machine of other work, or move more slowly");
    }
  } else if (const Status told = watch.finish(); !told) {
    status = told;
  } else if (!done && done.error().kind != ErrorKind::kCancelled) {
    status = std::unexpected(done.error());
  } else if (placed.single_block()) {
    status = fail(ErrorKind::kUsage,
                  "the camera sends the whole scan in one block, and nothing tells its rows' times",
                  file_.camera, "set a smaller height_px in camera_settings");
  } else if (done) {
    status =
        fail(ErrorKind::kDevice,
             "the camera stopped at " + position_text(axis_.rotary, placed.position().value_or(travel.from)) +
                 " before the end of the scan",
             file_.camera, "ask it for more profiles with ?rows=, or move faster");
  } else {
    status = stopped_short(file_, axis_.rotary, watch.track().last().value_or(travel.from));
  }
  if (status && !done && done.error().kind == ErrorKind::kDevice) {
    status = std::unexpected(done.error());  // all rows are there; the camera's own laser may be on
  }
  if (placed.begun()) {
    if (const auto remark = placed.pitch_remark()) {
      sink.remark(*remark);
    }
    sink.end(placed.tally());
  }
  return status;
}

Status RangeRig::stop() {
  stopped_->store(true);
  const Status of_camera = camera_.stop();
  const Status of_stage = stage_.stop();
  return of_stage ? of_camera : of_stage;
}

Status RangeRig::halt() {
  stopped_->store(true);
  const Status of_stage = stage_.emergency_stop();
  const Status of_camera = camera_.stop();
  return of_stage ? of_camera : of_stage;
}

}  // namespace dubsar
