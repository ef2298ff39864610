// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar calibrate: camera, laser plane and stage from pictures of a board.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/board.h"
#include "core/units.h"
#include "formats/calibration_json.h"
#include "formats/gray_file.h"
#include "station/calibration_run.h"
#include "station/command/calibrate.h"
#include "station/command/command.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"

namespace dubsar {

namespace {

struct Options {
  std::string source;
  std::string board;
  std::string serial;
  std::string out;
  std::string print;
  std::optional<double> temperature_c;
  VerifyOptions verify;
  LiveOptions live;
};

nlohmann::ordered_json report_json(const CalibrationReport& report, const std::vector<std::string>& unseen,
                                   const std::string& file) {
  // The file's own words, so that there is one form of a calibration and no second.
  nlohmann::ordered_json json =
      nlohmann::ordered_json::parse(calibration_to_json(report.rig), nullptr, false);
  json["pictures_left_out"] = unseen;
  json["missing"] = report.missing;
  if (!file.empty()) {
    json["file"] = file;
  }
  return json;
}

void print_report(const CalibrationReport& report, const std::vector<std::string>& unseen) {
  const RigCalibration& rig = report.rig;
  const CalibrationQuality& q = rig.quality;
  std::printf("camera: focal length %.1f x %.1f px (± %.1f), centre %.1f %.1f, from %d pictures\n",
              rig.camera.fx_px, rig.camera.fy_px, q.focal_sigma_px, rig.camera.cx_px, rig.camera.cy_px,
              q.board_views);
  std::printf("  corners off by %.3f px rms, %.1f µm on the board\n", q.corner_rms_px, q.corner_rms_um);
  if (rig.has_laser) {
    std::printf("laser plane: from %d pictures, stripe off by %.3f px rms, %.1f µm\n", q.stripe_views,
                q.stripe_rms_px, q.stripe_rms_um);
    std::printf("  one pixel is %.1f µm across, %.1f µm in depth\n", 1e3 * rig.field_per_px_mm(),
                1e3 * rig.depth_per_px_mm());
    std::printf(
        "  points are known to %.1f µm against each other over the volume%s (1 σ, from the covariance)\n",
        q.volume_sigma_um,
        rig.has_motion && rig.motion.kind == MotionKind::kTurntable ? ", turned by 30° to either side" : "");
  }
  if (rig.has_motion) {
    std::printf("stage: %s, direction known to %.3f°", motion_word(rig.motion.kind),
                deg_from_rad(q.axis_sigma_rad));
    if (rig.motion.kind == MotionKind::kLinear) {
      std::printf(", 1 mm of it is %.4f mm", rig.motion.direction.norm());
    }
    if (q.stage_positions > 0) {
      std::printf(", board off by %.1f µm rms at %d positions", q.stage_rms_um, q.stage_positions);
    }
    std::printf("\n");
  }
  for (const std::string& line : unseen) {
    std::printf("no board: %s\n", line.c_str());
  }
  for (const std::string& line : q.left_out) {
    std::printf("left out: %s\n", line.c_str());
  }
  for (const std::string& line : report.missing) {
    std::printf("next: %s\n", line.c_str());
  }
}

Result<int> print_board(const Options& options, const CommandContext& context) {
  const Result<BoardSpec> board = parse_board(options.board);
  if (!board) {
    return std::unexpected(board.error());
  }
  constexpr int kTexels = 100;
  if (Status status = write_gray_png(board_pattern(*board, kTexels), options.print); !status) {
    return std::unexpected(status.error());
  }
  const double dots_per_inch = 25.4 * kTexels / board->square_mm;
  if (context.json) {
    CommandContext::print(
        {{"picture", options.print}, {"square_mm", board->square_mm}, {"dots_per_inch", dots_per_inch}});
    return 0;
  }
  std::printf(
      "%s: print it so that a square is %g mm wide (%g dots per inch), glue it on a flat plate and measure "
      "it\n",
      options.print.c_str(), board->square_mm, dots_per_inch);
  return 0;
}

Result<int> calibrate(Options options, CommandContext& context) {
  if (!options.print.empty()) {
    return print_board(options, context);
  }
  if (options.verify.wanted()) {
    return verify_rig(options.verify, options.source, context);
  }
  if (options.live.wanted()) {
    const Result<std::string> belongs = take_pictures(options.live, options.board, options.source, context);
    if (!belongs) {
      return std::unexpected(belongs.error());
    }
    options.out = options.out.empty() ? *belongs : options.out;
  }
  const Result<CalibrateOutcome> outcome = calibrate_folder(
      {options.source, options.board, options.serial, options.out, options.temperature_c}, context.job);
  if (!outcome) {
    return std::unexpected(outcome.error());
  }
  if (context.json) {
    CommandContext::print(report_json(outcome->report, outcome->left_out, options.out));
  } else {
    finish_progress();
    print_report(outcome->report, outcome->left_out);
  }
  return outcome->report.missing.empty() ? 0 : 1;
}

/// The options that the job of the verb goes by: --print, --verify and --rig are one each.
std::vector<std::string> heard_with(const std::string& job) {
  if (job == "--print") {
    return {"--print", "--board"};
  }
  if (job == "--verify") {
    return {"--verify", "--calibration"};
  }
  if (job == "--rig") {
    return {"--rig",   "--board",       "--serial",       "--temperature",    "--out",           "--motion",
            "--stops", "--depth-range", "--plate-margin", "--board-exposure", "--laser-exposure"};
  }
  return {"--board", "--serial", "--temperature", "--out"};
}

/// What is said, and would pass unheard.
std::optional<Error> unheard_option(const CLI::App& verb) {
  const std::string job = [&verb]() -> std::string {
    for (const char* one : {"--print", "--verify", "--rig"}) {
      if (verb.count(one) > 0) {
        return one;
      }
    }
    return {};
  }();
  const std::vector<std::string> heard = heard_with(job);
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) {
      continue;
    }
    const std::string name = "--" + option->get_lnames().front();
    if (std::ranges::find(heard, name) != heard.end()) {
      continue;
    }
    if (job.empty()) {
      return Error{ErrorKind::kUsage, name + " says nothing without --rig", "calibrate",
                   "name the rig's file too, or leave it out"};
    }
    const bool logs = job == "--verify" && name == "--rig";
    return Error{ErrorKind::kUsage, name + " says nothing with " + job, "calibrate",
                 logs ? "name the rig's file with --calibration, beside which the log lies" : "leave it out"};
  }
  return std::nullopt;
}

}  // namespace

void add_calibrate(CLI::App& app, Action& chosen) {
  CLI::App* verb =
      app.add_subcommand("calibrate",
                         "Camera, laser plane and stage from pictures of a board; status 1 when "
                         "a board pose is missing. With --verify, "
                         "a measured artefact against its certificate; status 1 when it fails. With "
                         "--rig, takes the pictures first");
  const auto options = std::make_shared<Options>();
  CLI::Option* source =
      verb->add_option("source", options->source,
                       "a folder with a calibration.toml, or with pictures of the board (--board); "
                       "with --verify a scan of the artefact; with --rig the folder to take them to");
  verb->add_option("--board", options->board, "chessboard:9x6:25 (inner corners, mm) or charuco:9x7:5:3.7");
  verb->add_option("--serial", options->serial,
                   "of the camera; a rig refuses the calibration of another one");
  verb->add_option("--temperature", options->temperature_c,
                   "of the room, degrees Celsius; default: as calibration.toml says")
      ->check(in_range(-60.0, 60.0));
  verb->add_option("-o,--out", options->out, "the calibration, calibration.json");
  CLI::Option* print =
      verb->add_option("--print", options->print, "write the board of --board as a PNG for printing");
  print->excludes(source);
  add_verify_options(*verb, options->verify);
  add_live_options(*verb, options->live);
  verb->fallthrough();
  verb->callback([&chosen, options, verb] {
    if (options->source.empty() && options->print.empty()) {
      throw CLI::RequiredError("source");
    }
    chosen =
        with_safe_outputs({options->out, options->print},
                          [options, unheard = unheard_option(*verb)](CommandContext& c) {
                            return unheard ? Result<int>(std::unexpected(*unheard)) : calibrate(*options, c);
                          },
                          {options->source + "/calibration.toml", options->live.rig, options->verify.artefact,
                           options->verify.calibration});
  });
}

}  // namespace dubsar
