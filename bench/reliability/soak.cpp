// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-soak: one process scans simulated tablets, one after the other, the whole way: stream, store,
// register, plan, stitch, wedges, deliverables. Resident memory and open descriptors have to stay as they
// are.
//   dubsar-soak --tablets 1000
//   dubsar-soak --first 417 --tablets 1    one tablet again, by the seed that was printed for it
// Status 1 when the median memory of the last tenth is more than 5 % above that of the second tenth, when
// descriptors grow, or when a tablet got no mesh, no wedges or no pictures. Fewer than 20 tablets say nothing
// of memory.

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/support/options.h"
#include "core/heap.h"
#include "core/kept_blocks.h"
#include "core/order_statistics.h"
#include "station/engine.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;  ///< Ctrl-C ends it early, with the verdict on what there is

/// A line of /proc/self/status. "VmRSS:" is all that is resident; "RssAnon:" the part that the program wrote,
/// "RssFile:" the part that is pages of programs and libraries, which the system can drop and read again.
double status_mib(std::string_view name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name)) {
      return std::stod(line.substr(name.size())) / 1024;
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

double median(std::span<const double> values) {
  return median_of(std::vector<double>(values.begin(), values.end()));
}

int run(int argc, char** argv) {
  CLI::App app("Scans simulated tablets in one process and watches memory and descriptors");
  int tablets = 1000;
  int first = 1;
  int scans = 3;
  std::string size = "12x10x8";  // the smallest that gets a mesh of several scans, wedges and all pages
  double spacing_mm = 0.5;
  app.add_option("--tablets", tablets)->check(CLI::Range(1, 1000000));
  app.add_option("--first", first, "seed of the first tablet; the next one has the next seed")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--scans", scans, "of each tablet at most");
  app.add_option("--size", size, "of a tablet, mm");
  app.add_option("--spacing", spacing_mm, "mm");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }

  std::vector<double> resident;
  std::vector<double> own;
  std::vector<double> in_use;
  std::vector<double> kept;  // of large blocks, for the next who asks
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::vector<std::ptrdiff_t> descriptors;
  int failed = 0;
  int several = 0;  // tablets with two registered scans or more
  std::printf("tablet resident_MiB own_MiB in_use_MiB kept_MiB descriptors\n");
  for (int i = 0; i < tablets && (interrupted == 0); ++i) {
    const test::TemporaryFolder folder;
    EngineOptions options;
    options.device =
        "sim:?seed=" + std::to_string(first + i) + "&size=" + size + "&spacing=" + std::to_string(spacing_mm);
    options.session = folder.path() / "session";
    options.automatic = true;
    options.max_scans = scans;
    {
      std::vector<std::string> told;  // what the operator was told, for a tablet that was lost
      std::mutex telling;
      Engine engine(options, [&](const Event& event) {
        if (const auto* notice = std::get_if<Notice>(&event)) {
          const std::scoped_lock lock(telling);
          told.push_back(notice->text);
        }
      });
      JobContext job;
      const Result<EngineResult> done = engine.run(job);
      const std::string fault = !done                           ? done.error().line()
                                : done->device_error            ? done->device_error->line()
                                : done->files.mesh.empty()      ? "there is no mesh"
                                : done->files.wedges.empty()    ? "there are no wedges"
                                : done->files.six_views.empty() ? "there are no pictures"
                                                                : "";
      if (!fault.empty()) {
        ++failed;
        std::fprintf(stderr, "tablet %d (%s): %s\n", i + 1, options.device.c_str(), fault.c_str());
        for (const std::string& line : told) {
          std::fprintf(stderr, "  told: %s\n", line.c_str());
        }
      }
      several +=
          done && std::ranges::count(done->poses, PoseStatus::kRegistered, &ScanPose::status) > 1 ? 1 : 0;
    }
    resident.push_back(status_mib("VmRSS:"));
    own.push_back(status_mib("RssAnon:"));
    in_use.push_back(in_use_mib());
    kept.push_back(static_cast<double>(kept_blocks().kept_bytes()) / (1024 * 1024));
    descriptors.push_back(open_descriptors());
    if (i % std::max(1, tablets / 20) == 0 || i + 1 == tablets) {
      std::printf("%6d %12.1f %7.1f %10.2f %8.2f %6td\n", i + 1, resident.back(), own.back(), in_use.back(),
                  kept.back(), descriptors.back());
      std::fflush(stdout);
    }
  }
  std::printf("%zu tablets, %d failed, %d with several scans registered\n", resident.size(), failed, several);
  if (resident.size() < 20) {
    return failed == 0 ? 0 : 1;
  }
  // The first tenth warms up: pools of threads, caches of the allocator.
  const std::size_t tenth = resident.size() / 10;
  const auto early = [&](std::span<const double> values) { return median(values.subspan(tenth, tenth)); };
  const auto late = [&](std::span<const double> values) { return median(values.last(tenth)); };
  const double growth = late(resident) / early(resident) - 1;
  const bool flat = growth <= 0.05;
  const bool constant = descriptors.back() <= descriptors[tenth];
  for (std::size_t from = 0; from + tenth <= resident.size(); from += tenth) {
    const auto window = [&](std::span<const double> values) { return median(values.subspan(from, tenth)); };
    std::printf("tablets %5zu to %5zu: median resident %.1f MiB, of which written %.1f, in use %.2f MiB\n",
                from + 1, from + tenth, window(resident), window(own), window(in_use));
  }
  std::printf(
      "resident %.1f MiB after warm-up, %.1f MiB at the end (%+.1f %%): %s; in use %.2f and %.2f MiB\n",
      early(resident), late(resident), 100 * growth, flat ? "flat" : "NOT flat", early(in_use), late(in_use));
  std::printf("descriptors %td after warm-up, %td at the end: %s\n", descriptors[tenth], descriptors.back(),
              constant ? "constant" : "NOT constant");
  return flat && constant && failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  dubsar::map_large_blocks();  // as dubsar itself does
  return dubsar::run(argc, argv);
}
