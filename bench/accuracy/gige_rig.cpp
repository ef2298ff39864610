// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The whole way at full size: frames of a simulated rig as GigE Vision packets on a loopback to the aravis
// driver, a stage behind an emulated USB port that moves through, by `rig:` to a grid, against the true
// surface.
//   dubsar-gige-rig [--method adaptive|steger|gaussian|centroid] [--rows N] [--step MM] [--rate HZ]
//   [--contrast C …] [--f-number N] [--loss SHARE] [--seed N]

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "acquisition/device_uri.h"
#include "bench/support/options.h"
#include "bench/support/rig_tablet.h"
#include "build_paths.h"
#include "drivers/loader.h"
#include "sim/frame_rig.h"
#include "sim/speckle_bound.h"
#include "tests/support/gige_scanner.h"
#include "tests/support/grid_truth.h"

namespace dubsar {
namespace {

using Clock = std::chrono::steady_clock;

/// Scan times beside the grid: how fast the rows came.
struct TimedGrid : test::CollectGrid {
  bool profile(const Profile& profile) override {
    last = Clock::now();
    first = first == Clock::time_point{} ? last : first;
    return CollectGrid::profile(profile);
  }
  Clock::time_point first{}, last{};
};

int scan(const test::GigeScannerPlan& plan, const MeshQuery& truth, test::PeerProcess& stage,
         double bound_um) {
  test::GigeScanner scanner(plan, stage);
  if (!scanner.refusal().empty()) {
    std::fprintf(stderr, "dubsar-gige-rig: %s\n", scanner.refusal().c_str());
    return 3;
  }
  const DriverRegistry registry{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
  const auto uri = parse_device_uri("rig:" + scanner.rig_file().string());
  Result<Device> device = open_device(uri.value(), registry);
  TimedGrid sink;
  const Result<ScanOutcome> done = device ? device->scan(sink) : std::unexpected(device.error());
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().line().c_str());
    return 3;
  }
  const auto lost = static_cast<unsigned long long>(sink.tally.profiles_dropped);
  const RangeGrid grid = sink.grid();
  const double um_per_px = 1e3 * plan.truth.depth_per_px_mm();
  const test::DepthErrors errors = test::depth_errors(grid, scanner.tablet_from_grid(), truth, um_per_px);
  const Eigen::Vector3d per_mm = plan.truth.scanner_from_camera().rotation * plan.truth.motion.direction;
  const double seconds = std::chrono::duration<double>(sink.last - sink.first).count();
  std::printf(
      "  contrast %.2f: %d rows at %.1f/s, %llu lost, %s packets resent, %.1f%% of the samples; depth %.2f "
      "um rms, %.3f px of the picture, bias %.2f, without the %.3f%% that are off by more than a pixel "
      "(%.3f%% miss the surface); %.2f "
      "um with those within 0.2 mm",
      plan.optics.speckle_contrast, grid.rows, (grid.rows - 1) / seconds, lost,
      scanner.camera().tell("resent").c_str(),
      100.0 * static_cast<double>(grid.valid_count()) / static_cast<double>(grid.size()), errors.clean_um,
      errors.clean_um / um_per_px, errors.bias_um, 100 * (errors.off + errors.missed), 100 * errors.missed,
      errors.rms_um);
  if (bound_um > 0) {
    std::printf(" (bound of the speckle %.1f um: %.2f times)", bound_um, errors.clean_um / bound_um);
  }
  std::printf("; rows %.2f um from where their frames were taken\n",
              test::row_rms_um(grid, scanner.positions(), per_mm));
  std::fflush(stdout);
  const double allowed_um = bound_um > 0 ? std::min(1.2 * bound_um, 20.0) : 3.0;
  return lost == 0 && errors.clean_um <= allowed_um ? 0 : 1;
}

int run(int argc, char** argv) {
  CLI::App app("From GigE packets to a grid, against the truth", "dubsar-gige-rig");
  std::vector<double> contrasts{0, 0.7, 1};
  sim::FrameRigOptions size;
  test::GigeScannerPlan plan;
  plan.rows = 40;
  plan.rate_hz = 40;
  plan.optics.f_number = 5.6;
  std::uint64_t seed = 1;
  app.add_option("--rows", plan.rows)->check(CLI::Range(4, 2000));
  app.add_option("--rate", plan.rate_hz, "Of the camera, Hz")->check(CLI::Range(1.0, 1000.0));
  app.add_option("--step", plan.step, "From row to row, mm")->check(CLI::Range(0.005, 0.5));
  app.add_option("--contrast", contrasts, "Of the speckle");
  app.add_option("--f-number", plan.optics.f_number);
  app.add_option("--loss", plan.loss, "Share of the packets that are lost")->check(CLI::Range(0.0, 0.2));
  app.add_option("--seed", seed, "Of the tablet");
  app.add_option("--method", plan.method, "Of finding the stripe")
      ->check(CLI::IsMember({"adaptive", "steger", "gaussian", "centroid"}));
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  std::string why;
  test::PeerProcess* const stage = test::enter_emulated_machine(argv, why);
  if (stage == nullptr) {
    std::fprintf(stderr, "dubsar-gige-rig: %s\n", why.c_str());
    return 3;
  }
  int worst = 0;
  for (const bool written : {false, true}) {
    const Result<std::unique_ptr<RigTablet>> made = rig_tablet(written, seed);
    if (!made) {
      std::fprintf(stderr, "%s\n", made.error().line().c_str());
      return 4;
    }
    const RigTablet& clay = **made;
    plan.truth = sim::frame_rig(size);
    plan.scene = &clay.scene;
    plan.tablet_from_scanner.translation_mm.z() = clay.top_mm - 1.0;
    std::printf("%s tablet, %d x %d, field %.0f mm, f/%.1f, camera at %.0f/s, stage at %.2f mm/s\n",
                written ? "written" : "blank", size.width, size.height, size.field_mm, plan.optics.f_number,
                plan.rate_hz, plan.rate_hz * plan.step);
    for (const double contrast : contrasts) {
      plan.optics.speckle_contrast = contrast;
      worst = std::max(worst,
                       scan(plan, clay.query, *stage, sim::speckle_bound_um(plan.truth, plan.optics, size)));
    }
  }
  return worst;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
