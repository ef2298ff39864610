// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-red-latency: from the moment a profile reaches the engine to the end of the first frame of the
// window that shows it with its red, through the real engine and the real window: a scanner that hands over
// 100 profiles of 2048 samples a second, beside it all that a scan does otherwise. Prints what the window
// counted. Without a display it starts one of its own (Xvfb, drawn by the processor).

#include <CLI/CLI.hpp>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "bench/support/options.h"
#include "build_paths.h"
#include "core/job.h"
#include "core/log.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"
#include "ui/station_window.h"

int main(int argc, char** argv) {
  using namespace dubsar;
  CLI::App app("From a profile's arrival to the first frame that shows it", "dubsar-red-latency");
  if (const auto status = bench::ends_with(app, argc, argv)) {
    return *status;
  }
  setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/bench_drivers", 1);
  std::optional<test::Display> display;
  if (std::getenv("DISPLAY") == nullptr) {
    display.emplace();
  }
  const test::TemporaryFolder folder;
  const auto script = folder.path() / "one.script";
  std::ofstream(script) << "wait idle\nkey space\nwait scans.1 60\nwait waiting-turn 60\nquit\n";
  ui::StationWindowOptions options;
  options.session = folder.path() / "session";
  options.device = "paced:";
  options.script = script;
  set_log_level(LogLevel::kDebug);
  JobContext job;
  const Result<int> status = ui::run_station_window(options, job);
  if (!status) {
    std::fprintf(stderr, "%s\n", status.error().line().c_str());
    return 3;
  }
  return *status;
}
