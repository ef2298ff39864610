// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Calibration from rendered pictures against the truth of the simulated rig, in micrometres.
//   dubsar-calibration [--poses N] [--board SPEC] [--width PX] [--height PX] [--speckle C] [--seeds N]

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bench/support/asked.h"
#include "bench/support/options.h"
#include "bench/support/simulated_calibration.h"
#include "sim/frame_rig.h"

namespace dubsar {
namespace {

int run(int argc, char** argv) {
  CLI::App app("Calibration of simulated rigs against their truth", "dubsar-calibration");
  int poses = 15;
  int seeds = 1;
  std::string name = "charuco:14x9:4:2.96";
  sim::FrameRigOptions size;
  sim::FrameOptions optics;
  app.add_option("--poses", poses);
  app.add_option("--seeds", seeds);
  app.add_option("--board", name);
  app.add_option("--width", size.width);
  app.add_option("--height", size.height);
  app.add_option("--laser-sigma", optics.laser_sigma_mm);
  app.add_option("--speckle", optics.speckle_contrast);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  const Result<BoardSpec> board = parse_board(name);
  if (!board) {
    std::fprintf(stderr, "%s\n", board.error().line().c_str());
    return 2;
  }
  const RigCalibration truth = sim::frame_rig(size);
  Asked asked;
  for (int seed = 1; seed <= seeds; ++seed) {
    SimulatedBoard camera(truth, *board, optics);
    std::vector<CalibrationView> views;
    for (const RigidTransform& pose : sim::board_poses(truth, board->low_mm(), board->high_mm(), poses,
                                                       static_cast<std::uint64_t>(seed))) {
      if (auto view = camera.view(pose, true, 0, "pose " + std::to_string(views.size()))) {
        views.push_back(std::move(*view));
      }
    }
    const std::vector<double> positions{-6, -3, 0, 3, 6};
    std::size_t i = 0;
    for (const RigidTransform& pose :
         sim::carried_board(truth, board->low_mm(), board->high_mm(), positions)) {
      if (auto view = camera.view(pose, false, 0, "stage " + std::to_string(i))) {
        view->fixed = "board on stage";
        view->stage_position = positions[i];
        views.push_back(std::move(*view));
      }
      ++i;
    }
    CalibrationOptions options;
    options.board = *board;
    options.motion = MotionKind::kLinear;
    options.depth_range_mm = truth.depth_range_mm;
    const Result<CalibrationReport> report = calibrate_rig(views, options);
    if (!report) {
      std::printf("seed %d: %s\n", seed, report.error().line().c_str());
      asked.nothing_of("the laser plane");
      continue;
    }
    const RigCalibration& rig = report->rig;
    const double shear =
        std::acos(std::min(1.0, std::abs(rig.motion.direction.normalized().dot(rig.laser.normal))));
    std::printf(
        "seed %d, %d views, %d stripes: corners %.3f px (%.2f um), stripe %.3f px (%.2f um), focal length "
        "%+.2f "
        "px (s %.2f)\n",
        seed, rig.quality.board_views, rig.quality.stripe_views, rig.quality.corner_rms_px,
        rig.quality.corner_rms_um, rig.quality.stripe_rms_px, rig.quality.stripe_rms_um,
        rig.camera.fx_px - truth.camera.fx_px, rig.quality.focal_sigma_px);
    std::printf(
        "  laser plane over the volume: %.2f um at most after the best rigid placement (its own word: s %.2f "
        "um); "
        "%.1f um in the camera's frame\n",
        1e3 * shape_error_mm(truth, rig), rig.quality.volume_sigma_um, 1e3 * plane_error_mm(truth, rig));
    constexpr double kPlane_um = 20;
    asked.at_most("the laser plane over the volume", 1e3 * shape_error_mm(truth, rig), kPlane_um, "um");
    asked.at_most("the laser plane in the camera's frame", 1e3 * plane_error_mm(truth, rig), kPlane_um, "um");
    std::printf("  slide: scale %+.1f ppm, %.4f° from square to the plane (truth 0)\n",
                1e6 * (rig.motion.direction.norm() - 1), shear * 180 / M_PI);
  }
  return asked.status();
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
