// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_parts.h"

#include <algorithm>
#include <cmath>

#include "acquisition/setting_words.h"
#include "core/number_text.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kRunUpS = 0.3;     // to gather speed and for the readings around the first row
constexpr double kRunUpSteps = 10;  // and at least so many rows
constexpr double kRounding = 1e-6;  // of a step, as rig.toml counts its rows
constexpr std::chrono::seconds kRest(1);
constexpr std::chrono::seconds kGrace(2);  // to start and to brake

std::chrono::milliseconds milliseconds_of(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000 * seconds));
}

}  // namespace

Status put_off(Device& stage, std::uint32_t laser) {
  const Status off = stage.set_laser(laser, 0);
  return off ? off
             : fail(ErrorKind::kDevice, "the laser may still be on: " + off.error().what, stage.uri(),
                    "pull its plug before anybody reaches in");
}

Status LaserGuard::off(Status so_far) {
  if (is_off_) {
    return so_far;
  }
  const Status dark = put_off(stage_, laser_);
  is_off_ = dark.has_value();
  if (is_off_) {
    return so_far;
  }
  if (so_far || so_far.error().kind == ErrorKind::kCancelled) {
    return dark;
  }
  Error both = so_far.error();
  both.what += "; " + dark.error().what;
  both.mend = dark.error().mend + (both.mend.empty() ? "" : "; " + both.mend);
  return std::unexpected(std::move(both));
}

Status put_camera_settings(const RigFile& file, Device& camera, const std::string& where) {
  return put_settings(camera, file.camera_settings, where);
}

Result<StageAxis> axis_for_scan(const RigFile& file, Device& stage, MotionKind kind,
                                const std::string& where) {
  const Result<DeviceCapabilities> capable = stage.capabilities();
  if (!capable) {
    return std::unexpected(capable.error());
  }
  if (!capable->is_stage) {
    return fail(ErrorKind::kUsage, file.stage + " is no stage", where, "name a stage: see dubsar drivers");
  }
  const Result<std::vector<StageAxis>> axes = stage.axes();
  if (!axes) {
    return std::unexpected(axes.error());
  }
  if (static_cast<std::size_t>(file.axis) >= axes->size()) {
    return fail(ErrorKind::kUsage, "the stage has no axis " + std::to_string(file.axis), where,
                "it has " + std::to_string(axes->size()) + ", counted from 0");
  }
  const StageAxis& axis = (*axes)[static_cast<std::size_t>(file.axis)];
  if (axis.rotary != (kind != MotionKind::kLinear)) {
    return bad_input(
        where,
        "axis " + axis.name +
            (axis.rotary ? " turns, and the rig's goes straight" : " goes straight, and the rig's turns"),
        "set axis to the one that carries the camera or the tablet; axes=x:deg in the stage's URI "
        "says that x turns");
  }
  const double end = end_of(file);
  const double rounding = kRounding * std::abs(file.step);
  if (!axis.endless && (file.start < axis.minimum - rounding || end > axis.maximum + rounding)) {
    return fail(ErrorKind::kUsage,
                "the scan from " + position_text(axis.rotary, file.start) + " to " +
                    position_text(axis.rotary, end) + " leaves the axis' limits, " +
                    position_text(axis.rotary, axis.minimum) + " to " +
                    position_text(axis.rotary, axis.maximum),
                where, "scan less, or move the limits");
  }
  return axis;
}

double end_of(const RigFile& file) {
  return file.start + file.step * (file.rows - 1);
}

double row_position(const RigFile& file, const StageAxis& axis, int row) {
  const double there = file.start + file.step * row;
  return axis.endless ? there : std::clamp(there, axis.minimum, axis.maximum);
}

Status check_turn(const RigFile& file, MotionKind kind, const std::string& where) {
  constexpr double kWidestDeg = 120;
  const double turn_deg = deg_from_rad(end_of(file) - file.start);
  if (kind != MotionKind::kTurntable || turn_deg < kWidestDeg + 1e-6) {
    return {};
  }
  return fail(ErrorKind::kUsage,
              "the scan turns the tablet by " + position_text(true, end_of(file) - file.start) +
                  ", and what a scan sees is judged from one side",
              where, "let it turn by 120 degrees at most, and turn the tablet between scans");
}

Status check_unit(const RigFile& file, MotionKind kind, const std::string& where) {
  if (file.turns == (kind != MotionKind::kLinear)) {
    return {};
  }
  return file.turns ? bad_input(where, "the scan is said in degrees, and the rig's stage goes straight",
                                "say from_mm, to_mm and step_mm")
                    : bad_input(where, "the scan is said in millimetres, and the rig's stage turns",
                                "say from_deg, to_deg and step_deg");
}

Status check_zero(const StageAxis& axis, const Device& stage, MotionKind kind, const std::string& where) {
  if (kind != MotionKind::kGalvanometer || axis.can_home) {
    return {};
  }
  return bad_input(where,
                   "the mirror has no reference switch: where " + stage.uri() +
                       " counts from is another place each time it is switched on",
                   "give its axis a switch, and tell the controller of it");
}

std::string position_text(bool rotary, double position) {
  const double shown = rotary ? deg_from_rad(position) : position;
  return number_text(std::round(1000 * shown) / 1000) + (rotary ? "°" : " mm");
}

Result<double> position_of(const Device& stage, std::size_t axis) {
  const Result<StageReading> reading = stage.motion();
  if (!reading) {
    return std::unexpected(reading.error());
  }
  if (axis >= reading->position.size()) {
    return fail(ErrorKind::kDevice, "the stage does not tell where its axis " + std::to_string(axis) + " is",
                stage.uri(), "see the option axes= of its URI");
  }
  return reading->position[axis];
}

Status unless_stopped(const std::atomic<bool>& stopped, const RigFile& file) {
  return stopped ? fail(ErrorKind::kCancelled, "scan stopped", file.name) : Status{};
}

Status home_once(Device& stage, int axis, const std::function<Status()>& go_on) {
  const Result<StageReading> now = stage.motion();
  if (!now) {
    return std::unexpected(now.error());
  }
  const Result<std::vector<StageAxis>> axes = stage.axes();
  if (!axes) {
    return std::unexpected(axes.error());
  }
  const bool can_home = (*axes)[static_cast<std::size_t>(axis)].can_home;
  if (!can_home || now->homed) {
    return {};
  }
  const Status may = go_on ? go_on() : Status{};  // a stage that had to be found again took its time
  return may ? stage.home() : may;
}

Status check_reports(const StageReading& reading, const RigFile& file) {
  return reading.commanded
             ? fail(ErrorKind::kUsage, "the stage does not report where it is while it moves", file.stage,
                    "a stage that stops at each row, and a camera that yields pictures, can do with it")
             : Status{};
}

std::unexpected<Error> stopped_short(const RigFile& file, bool rotary, double position) {
  return fail(ErrorKind::kDevice,
              "the stage stopped at " + position_text(rotary, position) + " before the end of the scan",
              file.stage, "see whether something blocks it, and home it");
}

std::chrono::milliseconds Travel::time_of_way() const {
  return kGrace + milliseconds_of(1.5 * std::abs(to - from) / speed);
}

std::chrono::milliseconds Travel::time_to_rest(double last_row) const {
  return kRest + milliseconds_of(std::abs(to - last_row) / speed);
}

Travel travel_of(const RigFile& file, const StageAxis& axis, double speed) {
  const double run_up = std::max(kRunUpS * speed, kRunUpSteps * file.step);
  Travel out{file.start - run_up, file.start + file.step * (file.rows - 1) + run_up, speed};
  if (!axis.endless) {
    out.from = std::max(out.from, axis.minimum);
    out.to = std::min(out.to, axis.maximum);
  }
  return out;
}

}  // namespace dubsar
