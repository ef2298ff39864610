// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The cables of a whole rig pulled at random moments of its scans: an emulated camera (GigE Vision packets on
// a loopback) that dies, and an emulated stage (GRBL behind umockdev) that goes, with a board that lives on
// the cable or with one that has power of its own. After each: told as a device's failure and how soon, the
// rows until then kept, the laser dark as the controller itself has it, and the next scan runs.
//   dubsar-rig-unplug [--trials N] [--seed N]

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>
#include <vector>

#include "acquisition/device_uri.h"
#include "build_paths.h"
#include "core/mesh_query.h"
#include "drivers/loader.h"
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

/// One scan, one pull. False when the rig cannot be put together again.
bool trial(Device& rig, test::GigeScanner& scanner, test::PeerProcess& stage, Pull what, std::mt19937& random,
           int rows, Tally& tally) {
  const int row = static_cast<int>(random() % static_cast<unsigned>(rows - 6));
  Pulled sink(row, std::chrono::microseconds(random() % 20000),
              [&] { what == Pull::kCamera ? scanner.unplug_camera() : void(stage.tell("unplug")); });
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
  // back: the first word to it puts it off.
  if (what == Pull::kCamera) {
    tally.lit += stage.tell("laser") == "0" ? 0 : 1;
    scanner.plug_camera();
    return scanner.refusal().empty();
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
  app.add_option("--trials", trials)->check(CLI::Range(1, 100000));
  app.add_option("--seed", seed);
  CLI11_PARSE(app, argc, argv);
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
  test::GigeScanner scanner(plan, *stage);
  if (!scanner.refusal().empty()) {
    std::fprintf(stderr, "dubsar-rig-unplug: %s\n", scanner.refusal().c_str());
    return 3;
  }
  const DriverRegistry registry{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
  Result<Device> rig = open_device(parse_device_uri("rig:" + scanner.rig_file().string()).value(), registry);
  if (!rig) {
    std::fprintf(stderr, "%s\n", rig.error().line().c_str());
    return 3;
  }
  std::mt19937 random(seed);
  std::array<Tally, kNames.size()> tallies;
  for (int k = 0; k < trials; ++k) {
    const auto kind = static_cast<std::size_t>(k) % kNames.size();
    for (const int done = tallies[kind].trials; tallies[kind].trials == done;) {
      if (!trial(*rig, scanner, *stage, static_cast<Pull>(kind), random, plan.rows, tallies[kind])) {
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
