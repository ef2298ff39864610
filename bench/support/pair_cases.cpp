// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/pair_cases.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <utility>

#include "core/grid_lookup.h"
#include "core/order_statistics.h"
#include "core/random.h"
#include "core/units.h"
#include "formats/grid_reader.h"
#include "formats/poses_conf.h"

namespace dubsar::bench {

namespace {

/// The pairs of this overlap and more are the easy ones.
constexpr double kEasyOverlap = 0.54;
/// A sample overlaps when the other scan has one so near, mm.
constexpr double kOverlapReachMm = 1.0;

double share_on(const PublishedScan& from, const PublishedScan& into, const GridLookup& lookup,
                double reach_mm) {
  const RigidTransform into_from_from = into.model_from_scanner.inverse() * from.model_from_scanner;
  std::size_t sent = 0;
  std::size_t hit = 0;
  for (std::size_t i = 0; i < from.grid->size(); ++i) {
    if (from.grid->valid[i] != 0) {
      const Eigen::Vector3d p = into_from_from * Eigen::Vector3d(from.grid->point(i).cast<double>());
      ++sent;
      hit += lookup.nearest(p.cast<float>(), static_cast<float>(reach_mm)) >= 0 ? 1 : 0;
    }
  }
  return sent == 0 ? 0.0 : static_cast<double>(hit) / static_cast<double>(sent);
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0;
  }
  return median_of(std::move(values));
}

Eigen::Vector3d random_direction(Random& random) {
  return random.normal3().normalized();
}

/// One method over some of the pairs.
void print_row(const std::vector<PublishedScan>& scans, const std::vector<PairCase>& pairs,
               const PairMethod& method, const char* group, bool easy, int starts, std::uint64_t seed,
               bool verbose) {
  std::array<int, std::size(kStartClasses)> right{};
  int tried = 0;
  std::vector<double> turns;
  std::vector<double> shifts;
  std::vector<double> cpu_ms;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const PairCase& pair = pairs[p];
    if ((pair.overlap >= kEasyOverlap) != easy) {
      continue;
    }
    for (std::size_t c = 0; c < std::size(kStartClasses); ++c) {
      for (int s = 0; s < starts; ++s) {
        const RigidTransform start =
            off_start(pair, scans[pair.moved], kStartClasses[c],
                      seed_for(seed, 10000 * p + 1000 * c + static_cast<std::size_t>(s)));
        const double before_s = cpu_s();
        const RigidTransform found = method.align(pair.on, pair.moved, start);
        cpu_ms.push_back(1e3 * (cpu_s() - before_s));
        const AlignError error = error_of(pair, scans[pair.moved], found);
        right[c] += error.success() ? 1 : 0;
        tried += c == 0 ? 1 : 0;
        if (error.success()) {
          turns.push_back(error.turn_deg);
          shifts.push_back(error.shift_mm);
        } else if (verbose) {
          std::printf("    %s: %s onto %s from %.0f deg / %.0f mm, start %d: off by %.2f deg %.2f mm\n",
                      method.name.c_str(), scans[pair.moved].name.c_str(), scans[pair.on].name.c_str(),
                      kStartClasses[c].turn_deg, kStartClasses[c].shift_mm, s, error.turn_deg,
                      error.shift_mm);
        }
      }
    }
  }
  if (tried == 0) {
    return;
  }
  std::printf("%-30s %-8s", method.name.c_str(), group);
  for (const int r : right) {
    std::printf(" %6.1f", 100.0 * r / tried);
  }
  double sum = 0;
  for (const double ms : cpu_ms) {
    sum += ms;
  }
  std::printf("  %7.3f %7.3f %9.1f %9.1f %9.1f\n", median(turns), median(shifts),
              sum / static_cast<double>(cpu_ms.size()), median(cpu_ms), method.prepare_ms);
  std::fflush(stdout);
}

}  // namespace

std::vector<PublishedScan> read_published(const std::string& folder, const std::string& conf,
                                          double mm_per_file_unit) {
  std::vector<PublishedScan> scans;
  Result<std::vector<ScanPose>> published =
      read_conf_poses(std::filesystem::path(folder) / conf, mm_per_file_unit);
  if (!published) {
    std::fprintf(stderr, "%s\n", published.error().line().c_str());
    std::exit(2);
  }
  std::ranges::sort(*published, {}, &ScanPose::file);
  for (const ScanPose& scan_pose : *published) {
    const std::string& name = scan_pose.file;
    auto read = read_scan_file(std::filesystem::path(folder) / name, {.mm_per_unit = mm_per_file_unit});
    auto* grid = read && !read->empty() ? std::get_if<RangeGrid>(&read->front()) : nullptr;
    if (grid == nullptr) {
      std::fprintf(stderr, "%s: no range grid\n", name.c_str());
      std::exit(2);
    }
    if (!(grid->spacing_mm > 0)) {
      grid->spacing_mm = estimate_spacing_mm(*grid);
    }
    PublishedScan scan{name, std::make_shared<const RangeGrid>(std::move(*grid)),
                       scan_pose.model_from_scanner};
    for (std::size_t i = 0; i < scan.grid->size(); ++i) {
      if (scan.grid->valid[i] != 0) {
        scan.centroid_mm += scan.grid->point(i).cast<double>();
      }
    }
    scan.centroid_mm /= std::max(1.0, static_cast<double>(scan.grid->valid_count()));
    scans.push_back(std::move(scan));
  }
  if (scans.empty()) {
    std::fprintf(stderr, "%s: no scans that %s names\n", folder.c_str(), conf.c_str());
    std::exit(2);
  }
  return scans;
}

std::vector<PairCase> overlapping_pairs(const std::vector<PublishedScan>& scans, double least_overlap) {
  std::vector<PairCase> pairs;
  std::vector<std::unique_ptr<GridLookup>> lookups;
  lookups.reserve(scans.size());
  for (const PublishedScan& scan : scans) {
    lookups.push_back(std::make_unique<GridLookup>(*scan.grid));
  }
  for (std::size_t a = 0; a < scans.size(); ++a) {
    for (std::size_t b = a + 1; b < scans.size(); ++b) {
      const bool a_is_smaller = scans[a].grid->valid_count() < scans[b].grid->valid_count();
      const std::size_t moved = a_is_smaller ? a : b;
      const std::size_t on = a_is_smaller ? b : a;
      const double overlap = share_on(scans[moved], scans[on], *lookups[on], kOverlapReachMm);
      if (overlap >= least_overlap) {
        pairs.push_back(
            {on, moved, overlap, scans[on].model_from_scanner.inverse() * scans[moved].model_from_scanner});
      }
    }
  }
  return pairs;
}

RigidTransform off_start(const PairCase& pair, const PublishedScan& moved, const StartClass& by,
                         std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector3d axis = random_direction(random);
  const Eigen::Vector3d shift_mm = by.shift_mm * random_direction(random);
  const RigidTransform turn =
      RigidTransform::from_twist(rad_from_deg(by.turn_deg) * axis, Eigen::Vector3d::Zero());
  const Eigen::Vector3d center_mm = pair.on_from_moved * moved.centroid_mm;
  RigidTransform start = pair.on_from_moved;
  start.rotation = turn.rotation * start.rotation;
  start.translation_mm = turn.rotation * (start.translation_mm - center_mm) + center_mm + shift_mm;
  return start;
}

AlignError error_of(const PairCase& pair, const PublishedScan& moved, const RigidTransform& on_from_moved) {
  const RigidTransform turn{on_from_moved.rotation * pair.on_from_moved.rotation.transpose(), {0, 0, 0}};
  return {deg_from_rad(turn.angle_rad()),
          (on_from_moved * moved.centroid_mm - pair.on_from_moved * moved.centroid_mm).norm()};
}

double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void print_pair_table(const std::vector<PublishedScan>& scans, const std::vector<PairCase>& pairs,
                      const std::vector<PairMethod>& methods, int starts, std::uint64_t seed, bool verbose) {
  if (verbose) {
    for (const PairCase& pair : pairs) {
      const RigidTransform turn{pair.on_from_moved.rotation, {0, 0, 0}};
      std::printf("%s onto %s: overlap %.2f, %.0f deg apart\n", scans[pair.moved].name.c_str(),
                  scans[pair.on].name.c_str(), pair.overlap, deg_from_rad(turn.angle_rad()));
    }
  }
  std::printf("%-30s %-8s %6s %6s %6s  %7s %7s %9s %9s %9s\n", "method", "pairs", "5/5", "10/10", "20/20",
              "deg", "mm", "cpu ms", "median", "per scan");
  for (const PairMethod& method : methods) {
    print_row(scans, pairs, method, "easy", true, starts, seed, verbose);
    print_row(scans, pairs, method, "low", false, starts, seed, verbose);
  }
}

}  // namespace dubsar::bench
