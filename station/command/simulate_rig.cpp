// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar simulate rig: the pictures for a calibration, rendered.

#include <cstdio>
#include <memory>

#include "formats/calibration_json.h"
#include "station/command/command.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"
#include "station/command/simulate_rig.h"
#include "station/rig_pictures.h"

namespace dubsar {

namespace {

struct Options {
  RigPicturesOptions pictures;
  std::string motion = "linear";
  std::string out;
};

Result<int> simulate_rig(const Options& options, CommandContext& context) {
  RigPicturesOptions pictures = options.pictures;
  for (std::size_t i = 0; i < motion_words().size(); ++i) {
    if (motion_words()[i] == options.motion) {
      pictures.rig.motion = static_cast<MotionKind>(i);
    }
  }
  if (Status status = write_rig_pictures(pictures, options.out, context.job); !status) {
    return std::unexpected(status.error());
  }
  if (context.json) {
    CommandContext::print({{"folder", options.out}, {"poses", pictures.poses}});
  } else {
    finish_progress();
    std::printf("pictures in %s; calibrate them with: dubsar calibrate %s -o calibration.json\n",
                options.out.c_str(), options.out.c_str());
  }
  return 0;
}

}  // namespace

void add_simulate_rig(CLI::App& simulate, Action& chosen) {
  CLI::App* verb = simulate.add_subcommand(
      "rig", "Pictures of a calibration board before a simulated rig, and truth.json");
  const auto options = std::make_shared<Options>();
  RigPicturesOptions& pictures = options->pictures;
  verb->add_option("--motion", options->motion, "of the rig")
      ->check(CLI::IsMember(motion_words()))
      ->capture_default_str();
  verb->add_option("--poses", pictures.poses, "of the board, held by hand")
      ->check(in_range(1, 200))
      ->capture_default_str();
  verb->add_option("--stops", pictures.stops, "of the stage with the board on it")
      ->check(in_range(0, 200))
      ->capture_default_str();
  verb->add_option("--board", pictures.board, "as calibrate takes it")->capture_default_str();
  verb->add_option("--width", pictures.rig.width, "px")->check(in_range(64, 8192))->capture_default_str();
  verb->add_option("--height", pictures.rig.height, "px")->check(in_range(64, 8192))->capture_default_str();
  verb->add_option("--field", pictures.rig.field_mm, "mm across the picture")
      ->check(in_range(1.0, 500.0))
      ->capture_default_str();
  verb->add_option("--laser-sigma", pictures.optics.laser_sigma_mm, "of the laser sheet, mm")
      ->check(in_range(0.002, 1.0))
      ->capture_default_str();
  verb->add_option("--speckle", pictures.optics.speckle_contrast, "contrast, 0 to 1")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--seed", pictures.seed, "the same seed gives the same bytes")
      ->check(not_negative())
      ->capture_default_str();
  verb->add_option("-o,--out", options->out, "folder")->required();
  verb->fallthrough();
  verb->callback([&chosen, options] {
    chosen = with_safe_outputs({as_folder(options->out)},
                               [options](CommandContext& c) { return simulate_rig(*options, c); });
  });
}

}  // namespace dubsar
