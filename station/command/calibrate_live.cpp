// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar calibrate --rig: the pictures are taken with the rig itself.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "acquisition/live_calibration.h"
#include "acquisition/rig_device.h"
#include "acquisition/rig_parts.h"
#include "formats/calibration_json.h"
#include "station/calibration_run.h"
#include "station/command/calibrate.h"
#include "station/command/command.h"
#include "station/command/device_wait.h"
#include "station/command/operator_lines.h"
#include "station/command/option_checks.h"
#include "station/command/terminal.h"

namespace dubsar {

namespace {

LiveCalibrationPlan plan_for(const LiveOptions& options, const RigFile& rig, const std::string& board,
                             const std::string& folder) {
  LiveCalibrationPlan plan;
  plan.set.board = board;
  if (options.motion.empty()) {
    plan.set.motion = stage_kind_of("rig:" + options.rig);
  } else if (options.motion != "none") {
    const auto& words = motion_words();
    const auto found = std::find(words.begin(), words.end(), options.motion);
    plan.set.motion = static_cast<MotionKind>(found - words.begin());
  }
  plan.depth_range_mm = options.depth_range_mm;
  plan.plate_margin_mm = options.plate_margin_mm;
  plan.set.stripe_sigma_px = rig.stripe_sigma_px;
  plan.set.stripe_per_row = rig.stripe_per_row;
  plan.folder = folder;
  plan.axis = rig.axis;
  plan.laser = rig.laser;
  plan.laser_power = rig.laser_power;
  plan.from = rig.start;
  plan.to = rig.start + rig.step * (rig.rows - 1);
  plan.speed = rig.speed;
  plan.stops = options.stops;
  if (options.board_exposure_us > 0) {
    plan.board_exposure_us = options.board_exposure_us;
  }
  if (options.laser_exposure_us > 0) {
    plan.laser_exposure_us = options.laser_exposure_us;
  }
  return plan;
}

void tell(const std::string& line) {
  finish_progress();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void tell_next(const LiveCalibration& live) {
  const std::vector<std::string> next = live.next();
  tell(std::to_string(live.poses()) + " poses, " + std::to_string(live.stops()) + " positions of the stage");
  for (std::size_t i = 0; i < std::min<std::size_t>(next.size(), 3); ++i) {
    tell("next: " + next[i]);
  }
  if (next.empty()) {
    tell("nothing is missing: q");
  }
  tell("Enter: take this pose; s: the board lies on the stage; q: that is all");
}

}  // namespace

void add_live_options(CLI::App& verb, LiveOptions& options) {
  verb.add_option("--rig", options.rig,
                  "rig.toml, whose camera and stage take the pictures; the calibration goes where it says");
  verb.add_option(
          "--motion", options.motion,
          "with --rig: what the stage does; default: as the rig's files tell (a scan in degrees: turntable)")
      ->check(CLI::IsMember({"linear", "turntable", "galvanometer", "none"}));
  verb.add_option("--stops", options.stops, "with --rig: positions of the stage")
      ->check(in_range(3, 50))
      ->capture_default_str();
  verb.add_option("--depth-range", options.depth_range_mm, "with --rig: of the measuring volume, mm")
      ->check(in_range(1.0, 2000.0));
  verb.add_option("--plate-margin", options.plate_margin_mm, "with --rig: of flat plate around the print, mm")
      ->check(in_range(0.0, 500.0));
  verb.add_option("--board-exposure", options.board_exposure_us, "with --rig: for pictures of the board, us")
      ->check(in_range(1.0, 1e7));
  verb.add_option("--laser-exposure", options.laser_exposure_us, "with --rig: for pictures of the stripe, us")
      ->check(in_range(1.0, 1e7));
}

Result<std::string> take_pictures(const LiveOptions& options, const std::string& board,
                                  const std::string& folder, CommandContext& context) {
  if (board.empty()) {
    return fail(ErrorKind::kUsage, "nobody says what board it is", options.rig,
                "say --board, such as chessboard:9x6:25 or charuco:9x7:5:3.7");
  }
  const DevicePatience patience = patience_with_device(context);
  const DriverRegistry registry;
  Result<RigParts> parts = open_rig_parts(options.rig, registry);
  if (!parts) {
    return std::unexpected(parts.error());
  }
  const std::string belongs =
      (std::filesystem::path(options.rig).parent_path() / parts->file.calibration).string();
  if (parts->file.calibration.empty()) {
    return fail(ErrorKind::kUsage, "a range camera is calibrated by its maker", options.rig,
                "scan with it: dubsar scan --device rig:" + options.rig);
  }
  const LiveCalibrationPlan plan = plan_for(options, parts->file, board, folder);
  if (const Status unit = plan.set.motion ? check_unit(parts->file, *plan.set.motion, options.rig) : Status{};
      !unit) {
    return std::unexpected(unit.error());
  }
  Result<LiveCalibration> live =
      LiveCalibration::start(plan, std::move(parts->camera), std::move(parts->stage), context.job);
  if (!live) {
    return std::unexpected(live.error());
  }
  outlive_readers();
  OperatorLines lines([&job = context.job] { return job.cancelled(); });
  tell_next(*live);
  for (std::optional<std::string> line = lines.next(); line && *line != "q"; line = lines.next()) {
    if (!line->empty() && *line != "s") {
      tell("Enter, s or q");
      continue;
    }
    const Result<LiveCalibration::Taken> taken =
        line->empty() ? live->take_pose(context.job) : live->take_stops(context.job);
    // A camera or a stage that is gone can be plugged in again, one with a switch be homed, and what this rig
    // does not do be left: what was taken is kept either way.
    const auto ends_it = [](ErrorKind kind) {
      return kind != ErrorKind::kDevice && kind != ErrorKind::kUsage && kind != ErrorKind::kCancelled;
    };
    if (!taken && ends_it(taken.error().kind)) {
      return std::unexpected(taken.error());
    }
    if (context.job.cancelled()) {
      if (!taken && taken.error().kind == ErrorKind::kDevice) {  // it does not say that the laser is off
        return std::unexpected(taken.error());
      }
      break;
    }
    tell(taken ? (taken->used ? "taken: " : "of no use: ") + taken->said : taken.error().line());
    tell_next(*live);
  }
  if (context.job.cancelled()) {
    return fail(ErrorKind::kCancelled, "calibration cancelled; the pictures are kept", folder,
                "the same command goes on with them");
  }
  if (live->poses() == 0) {
    return fail(ErrorKind::kUsage, "no picture was taken", folder, "press Enter for each pose of the board");
  }
  return belongs;
}

}  // namespace dubsar
