// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-opening: seconds to open a session of many large scans, every grid read and compared with its
// checksum, with its files in the page cache and without.
//   dubsar-opening --scans 40 --samples 1000000

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "acquisition/session_store.h"
#include "bench/support/options.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

/// A wavy surface with a scanner's noise: packs about as badly as a real scan.
RangeGrid wavy_grid(int samples, std::uint64_t seed) {
  const int side = static_cast<int>(std::sqrt(samples));
  RangeGrid grid;
  grid.allocate(side, side);
  grid.spacing_mm = 0.05;
  Random random(seed);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = 1;
    grid.x[i] = static_cast<float>(0.05 * grid.col_of(i) + 0.001 * random.normal());
    grid.y[i] = static_cast<float>(0.05 * grid.row_of(i) + 0.001 * random.normal());
    grid.z[i] = static_cast<float>(std::sin(0.3 * static_cast<double>(grid.x[i])) + 0.01 * random.normal());
  }
  return grid;
}

/// Asks the system to forget what it holds of the files.
void forget(const fs::path& folder) {
  ::sync();
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (const int fd = entry.is_regular_file() ? ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC) : -1;
        fd >= 0) {
      ::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
      ::close(fd);
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app("Seconds to open a large session");
  int scans = 40;
  int samples = 1000000;
  app.add_option("--scans", scans);
  app.add_option("--samples", samples, "of each scan");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }

  const test::TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "session";
  {
    Result<SessionStore> store = SessionStore::open_or_create(folder);
    for (int i = 0; store && i < scans; ++i) {
      if (const auto stored = store->add_grid(wavy_grid(samples, static_cast<std::uint64_t>(i))); !stored) {
        std::fprintf(stderr, "%s\n", stored.error().line().c_str());
        return 1;
      }
    }
  }
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    bytes += entry.is_regular_file() ? entry.file_size() : 0;
  }
  std::printf("%d scans of %d samples, %.0f MB\n", scans, samples, static_cast<double>(bytes) / 1e6);
  constexpr double kOpensWithinS = 1;
  bool good = true;
  for (const bool cold : {true, false}) {
    for (const auto access : {SessionStore::Access::kReadWrite, SessionStore::Access::kReadOnly}) {
      if (cold) {
        forget(folder);
      }
      const auto start = std::chrono::steady_clock::now();
      const Result<SessionStore> store = SessionStore::open(folder, access);
      const double seconds = seconds_since(start);
      std::printf("%s, %s: %.3f s%s\n", cold ? "from the disk" : "from memory",
                  access == SessionStore::Access::kReadWrite ? "for writing" : "for reading", seconds,
                  store && store->opening().damage.empty() ? "" : " DAMAGED");
      good = good && store && store->opening().damage.empty() && seconds <= kOpensWithinS;
    }
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
