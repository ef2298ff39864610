// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-soak: one process scans simulated tablets, one after the other, the whole way: stream, store,
// register, plan, stitch, wedges, deliverables. Resident memory and open descriptors have to stay as they
// are.
//   dubsar-soak --tablets 1000
// Status 1 when the memory of the last tenth is more than 5 % above that after warm-up, or descriptors grow.

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "station/engine.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;  ///< Ctrl-C ends it early, with the verdict on what there is

double resident_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) {
      return std::stod(line.substr(6)) / 1024;
    }
  }
  return 0;
}

std::ptrdiff_t open_descriptors() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

/// In use by the program, in all arenas: what grows here is a leak, what grows in resident memory alone is
/// not.
double in_use_mib() {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* into = ::open_memstream(&text, &size);
  if (into == nullptr || ::malloc_info(0, into) != 0) {
    return 0;
  }
  std::fclose(into);
  const std::string xml(text, size);
  std::free(text);
  // The totals stand last: what was taken from the system, less what lies free.
  const auto total = [&](const char* what) {
    const std::size_t at = xml.rfind(what);
    const std::size_t from = at == std::string::npos ? at : xml.find("size=\"", at);
    return from == std::string::npos ? 0.0 : std::stod(xml.substr(from + 6));
  };
  const double taken = total("<system type=\"current\"") + total("<total type=\"mmap\"");
  return (taken - total("<total type=\"fast\"") - total("<total type=\"rest\"")) / (1024 * 1024);
}

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

int run(int argc, char** argv) {
  CLI::App app("Scans simulated tablets in one process and watches memory and descriptors");
  int tablets = 1000;
  int scans = 3;
  std::string size = "14x11x8";
  double spacing_mm = 0.5;
  app.add_option("--tablets", tablets)->check(CLI::Range(20, 1000000));
  app.add_option("--scans", scans, "of each tablet at most");
  app.add_option("--size", size, "of a tablet, mm");
  app.add_option("--spacing", spacing_mm, "mm");
  CLI11_PARSE(app, argc, argv);

  std::vector<double> resident;
  std::vector<double> in_use;
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::vector<std::ptrdiff_t> descriptors;
  int failed = 0;
  std::printf("tablet resident_MiB in_use_MiB descriptors\n");
  for (int i = 0; i < tablets && (interrupted == 0 || i < 20); ++i) {
    const test::TemporaryFolder folder;
    EngineOptions options;
    options.device =
        "sim:?seed=" + std::to_string(i + 1) + "&size=" + size + "&spacing=" + std::to_string(spacing_mm);
    options.session = folder.path() / "session";
    options.automatic = true;
    options.max_scans = scans;
    {
      Engine engine(options, [](const Event&) {});
      JobContext job;
      if (const Result<EngineResult> done = engine.run(job); !done) {
        ++failed;
        std::fprintf(stderr, "tablet %d: %s\n", i, done.error().line().c_str());
      }
    }
    resident.push_back(resident_mib());
    in_use.push_back(in_use_mib());
    descriptors.push_back(open_descriptors());
    if (i % std::max(1, tablets / 20) == 0 || i + 1 == tablets) {
      std::printf("%6d %12.1f %10.1f %6td\n", i + 1, resident.back(), in_use.back(), descriptors.back());
      std::fflush(stdout);
    }
  }
  // The first tenth warms up: pools of threads, caches of the allocator.
  const std::size_t tenth = resident.size() / 10;
  const double early = mean(std::span(resident).subspan(tenth, tenth));
  const double late = mean(std::span(resident).last(tenth));
  std::printf("in use %.2f MiB after warm-up, %.2f MiB at the end\n",
              mean(std::span(in_use).subspan(tenth, tenth)), mean(std::span(in_use).last(tenth)));
  const bool flat = late <= 1.05 * early;
  const bool constant = descriptors.back() <= descriptors[tenth];
  std::printf(
      "%zu tablets, %d of them failed; resident %.1f MiB after warm-up, %.1f MiB at the end (%+.1f %%): %s\n",
      resident.size(), failed, early, late, 100 * (late / early - 1), flat ? "flat" : "NOT flat");
  std::printf("descriptors %td after warm-up, %td at the end: %s\n", descriptors[tenth], descriptors.back(),
              constant ? "constant" : "NOT constant");
  return flat && constant ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
