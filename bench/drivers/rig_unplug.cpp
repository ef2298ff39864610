// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The cables of a whole rig pulled at random moments of its scans: an emulated camera (GigE Vision packets on
// a loopback) that dies, and an emulated stage (GRBL behind umockdev) that goes, with a board that lives on
// the cable or with one that has power of its own. After each: told as a device's failure and how soon, the
// rows until then kept, the laser dark as the controller itself has it, and the next scan runs. With --camera
// v4l2 the camera is one of V4L2 (FUSE) that shows no tablet, and it alone is pulled: rows are rows.
//   dubsar-rig-unplug [--camera gige|v4l2] [--trials N] [--seed N]

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <random>
#include <thread>
#include <vector>

#include "acquisition/device_uri.h"
#include "bench/support/options.h"
#include "build_paths.h"
#include "core/mesh_query.h"
#include "drivers/loader.h"
#include "formats/calibration_json.h"
#include "sim/tablet.h"
#include "tests/support/gige_scanner.h"
#include "tests/support/grid_truth.h"

namespace dubsar {
namespace {

using Clock = std::chrono::steady_clock;

enum class Pull { kCamera, kStage, kPoweredStage };
constexpr std::array kNames{"camera", "stage on the cable's power", "stage with power of its own"};

/// A scan during which something is pulled a moment after a row.
struct Pulled : test::CollectGrid {
  Pulled(int wanted, std::chrono::microseconds later, std::function<void()> what)
      : row(wanted), wait(later), pull(std::move(what)) {}
  bool profile(const Profile& profile) override {
    const bool more = CollectGrid::profile(profile);
    if (!when && profile.row >= row) {
      std::this_thread::sleep_for(wait);
      pull();
      when = Clock::now();
    }
    return more;
  }
  int row;
  std::chrono::microseconds wait;
  std::function<void()> pull;
  std::optional<Clock::time_point> when;
};

struct Tally {
  int trials = 0, again = 0, not_told = 0, rows_lost = 0, lit = 0;
  std::vector<double> seconds;
  [[nodiscard]] int faults() const { return not_told + rows_lost + lit; }
};

/// A camera's, as the kernel or the network has it.
struct Cable {
  std::function<void()> unplug;
  std::function<bool()> plug;  ///< whether the camera is back
};

/// A rig of a V4L2 camera and the stage.
class V4l2Rig {
 public:
  V4l2Rig(const test::GigeScannerPlan& plan, test::PeerProcess& stage)
      : camera_({DUBSAR_BINARY_DIR "/bin/v4l2_peer", node_.path().string(), "Bench",
                 "GREY:" + std::to_string(plan.truth.camera.width) + "x" +
                     std::to_string(plan.truth.camera.height) + "@20"}) {
    stage.tell("firmware grbl");
    RigCalibration calibration = plan.truth;
    calibration.made_at = "2026-01-01T00:00:00Z";
    std::ofstream(folder_.path() / "calibration.json") << calibration_to_json(calibration);
    std::ofstream(file()) << "name = 'emulated'\ncamera = 'v4l2:" << (node_.path() / "video0").string()
                          << "'\nstage = 'usb_stage:2341:0043'\ncalibration = 'calibration.json'\n[scan]\n"
                          << "from_mm = " << plan.start
                          << "\nto_mm = " << plan.start + plan.step * (plan.rows - 1)
                          << "\nstep_mm = " << plan.step << "\ncontinuous = true\n";
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "rig.toml"; }
  [[nodiscard]] std::string refusal() const { return camera_.refusal(); }
  [[nodiscard]] Cable cable() {
    return {[this] { camera_.tell("unplug"); }, [this] { return camera_.tell("plug") == "ok"; }};
  }

 private:
  test::TemporaryFolder folder_, node_;
  test::PeerProcess camera_;
};

/// One scan, one pull. False when the rig cannot be put together again.
bool trial(Device& rig, const Cable& camera, test::PeerProcess& stage, Pull what, std::mt19937& random,
           int rows, Tally& tally) {
  const int row = static_cast<int>(random() % static_cast<unsigned>(rows - 6));
  Pulled sink(row, std::chrono::microseconds(random() % 20000),
              [&] { what == Pull::kCamera ? camera.unplug() : void(stage.tell("unplug")); });
  const Result<ScanOutcome> scanned = rig.scan(sink);
  const Clock::time_point told = Clock::now();
  if (!sink.when) {
    // On a machine that has other things to do rows may be lost, and with them the moment.
    std::fprintf(stderr, "again: %s\n",
                 scanned ? "the scan ended before its cable was pulled" : scanned.error().line().c_str());
    return ++tally.again <= 20;
  }
  ++tally.trials;
  tally.seconds.push_back(std::chrono::duration<double>(told - *sink.when).count());
  tally.not_told += !scanned && scanned.error().kind == ErrorKind::kDevice ? 0 : 1;
  tally.rows_lost += sink.builder->grid().rows > row ? 0 : 1;
  // A stage that is there is dark by now. One that went may burn on, where it has power, until its cable is
  // back: the first word to it, the guard's or the scan's, puts it off.
  if (what == Pull::kCamera) {
    tally.lit += stage.tell("laser") == "0" ? 0 : 1;
    return camera.plug();
  }
  stage.tell(what == Pull::kStage ? "plug" : "rejoin");
  struct Looks : test::CollectGrid {
    bool begin(const ScanInfo& /*info*/) override { return false; }
  } looks;
  const Result<ScanOutcome> none = rig.scan(looks);
  tally.lit += !none && none.error().kind == ErrorKind::kCancelled && stage.tell("laser") == "0" ? 0 : 1;
  return true;
}

int run(int argc, char** argv) {
  CLI::App app("A rig's cables pulled in mid-scan", "dubsar-rig-unplug");
  int trials = 100;
  unsigned seed = 2026;
  std::string which = "gige";
  app.add_option("--trials", trials)->check(CLI::Range(1, 100000));
  app.add_option("--seed", seed);
  app.add_option("--camera", which)->check(CLI::IsMember({"gige", "v4l2"}));
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  std::string why;
  test::PeerProcess* const stage = test::enter_emulated_machine(argv, why);
  if (stage == nullptr) {
    std::fprintf(stderr, "dubsar-rig-unplug: %s\n", why.c_str());
    return 3;
  }
  sim::TabletOptions wanted;
  wanted.size_mm = {12, 10, 6};
  JobContext job;
  const Result<sim::SimTablet> tablet = sim::make_tablet(wanted, job);
  if (!tablet) {
    std::fprintf(stderr, "%s\n", tablet.error().line().c_str());
    return 4;
  }
  const MeshQuery query(tablet->mesh);
  sim::Scene scene;
  scene.tablet = &*tablet;
  scene.query = &query;
  test::GigeScannerPlan plan = test::small_gige_scanner(scene);
  plan.rate_hz = 20;
  std::optional<test::GigeScanner> gige;
  std::optional<V4l2Rig> v4l2;
  Cable cable;
  if (which == "gige") {
    gige.emplace(plan, *stage);
    cable = {[&] { gige->unplug_camera(); },
             [&] {
               gige->plug_camera();
               return gige->refusal().empty();
             }};
  } else {
    v4l2.emplace(plan, *stage);
    cable = v4l2->cable();
  }
  const std::string refusal = gige ? gige->refusal() : v4l2->refusal();
  const std::filesystem::path file = gige ? gige->rig_file() : v4l2->file();
  if (!refusal.empty()) {
    std::fprintf(stderr, "dubsar-rig-unplug: %s\n", refusal.c_str());
    return 3;
  }
  const DriverRegistry registry{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
  Result<Device> rig = open_device(parse_device_uri("rig:" + file.string()).value(), registry);
  if (!rig) {
    std::fprintf(stderr, "%s\n", rig.error().line().c_str());
    return 3;
  }
  std::mt19937 random(seed);
  std::array<Tally, kNames.size()> tallies;
  for (int k = 0; k < trials; ++k) {
    const auto kind = static_cast<std::size_t>(k) % (gige ? kNames.size() : 1);
    for (const int done = tallies[kind].trials; tallies[kind].trials == done;) {
      if (!trial(*rig, cable, *stage, static_cast<Pull>(kind), random, plan.rows, tallies[kind])) {
        std::fputs("dubsar-rig-unplug: the rig does not go on\n", stderr);
        return 1;
      }
    }
  }
  test::CollectGrid last;
  const Result<ScanOutcome> whole = rig->scan(last);
  int faults = whole && last.builder->grid().rows >= plan.rows - 2 ? 0 : 1;
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    Tally& tally = tallies[kind];
    if (tally.seconds.empty()) {
      continue;
    }
    std::ranges::sort(tally.seconds);
    std::printf(
        "%s: pulled %d times; told after %.2f s at the median, %.2f s at most; not told as a device's "
        "failure %d, rows lost %d, laser left on %d\n",
        kNames[kind], tally.trials, tally.seconds[tally.seconds.size() / 2], tally.seconds.back(),
        tally.not_told, tally.rows_lost, tally.lit);
    faults += tally.faults() + (tally.seconds.back() > 2 ? 1 : 0);
  }
  std::printf("the scan after the last one: %s\n", whole ? "whole" : whole.error().line().c_str());
  return faults == 0 ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
