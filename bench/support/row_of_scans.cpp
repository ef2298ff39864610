// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/row_of_scans.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/order_statistics.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"

namespace dubsar::bench {

namespace {

/// A border of fewer samples does not tell where its column lies.
constexpr std::size_t kLeastInColumn = 5;
/// How far beyond the tablet's ends its first and last scan show it: a hand-made body is not quite its size.
constexpr double kBeyondEndMm = 5;

[[noreturn]] void give_up(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  std::exit(2);
}

/// The columns whose median true x lies within, and those between them.
RangeGrid cut(const TrueScan& whole, double low_mm, double high_mm) {
  const RangeGrid& from = *whole.grid;
  int first = from.cols;
  int last = -1;
  for (int col = 0; col < from.cols; ++col) {
    std::vector<double> x_mm;
    for (int row = 0; row < from.rows; ++row) {
      if (from.is_valid(row, col)) {
        const Eigen::Vector3f p_mm = from.point(from.index(row, col));
        x_mm.push_back((whole.tablet_from_scanner * Eigen::Vector3d(p_mm.cast<double>())).x());
      }
    }
    if (x_mm.size() < kLeastInColumn) {
      continue;
    }
    const double middle_mm = median_of(std::move(x_mm));
    if (middle_mm >= low_mm && middle_mm <= high_mm) {
      first = std::min(first, col);
      last = col;
    }
  }
  RangeGrid piece;
  piece.allocate(from.rows, std::max(0, last - first + 1));
  piece.spacing_mm = from.spacing_mm;
  piece.view = from.view;
  piece.device = from.device;
  piece.intensity.resize(piece.size());
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const std::size_t of = from.index(piece.row_of(i), first + piece.col_of(i));
    piece.x[i] = from.x[of];
    piece.y[i] = from.y[of];
    piece.z[i] = from.z[of];
    piece.valid[i] = from.valid[of];
    piece.intensity[i] = from.intensity[of];
  }
  return piece;
}

/// The whole obverse, once for each place in the row, each time laid down and measured anew.
std::vector<TrueScan> whole_scans(const RowOptions& options) {
  JobContext job;
  sim::TabletOptions tablet_options;
  tablet_options.seed = options.seed;
  tablet_options.size_mm = options.size_mm;
  tablet_options.spacing_mm = options.spacing_mm;
  tablet_options.damage = {0.1, 0.1, 0.1, 0.1};
  const auto tablet = sim::make_tablet(tablet_options, job);
  if (!tablet) {
    give_up(tablet.error());
  }
  const MeshQuery query(tablet->mesh);
  const sim::Scene scene{&*tablet, &query, {}, std::nullopt};
  sim::ScannerOptions scanner = sim::scanner_for(options.size_mm, options.spacing_mm, options.noise_mm);
  std::vector<TrueScan> scans;
  for (int k = 0; k < options.scans; ++k) {
    scanner.seed = options.seed * 100 + static_cast<std::uint64_t>(k);
    const RigidTransform pose = sim::plan_views(1, scanner.seed).front().tablet_from_scanner;
    auto grid = sim::TriangulationScanner(scanner).scan_grid(scene, pose, 0, job);
    if (!grid) {
      give_up(grid.error());
    }
    scans.push_back({std::make_shared<const RangeGrid>(std::move(*grid)), pose, {}, 0});
  }
  return scans;
}

}  // namespace

std::vector<std::vector<TrueScan>> rows_of_scans(const RowOptions& options) {
  const std::vector<TrueScan> whole = whole_scans(options);
  std::vector<std::vector<TrueScan>> rows(static_cast<std::size_t>(options.sets));
  for (std::size_t set = 0; set < rows.size(); ++set) {
    for (int k = 0; k < options.scans; ++k) {
      TrueScan scan = whole[(static_cast<std::size_t>(k) + set) % whole.size()];
      const double low_mm = options.begin_mm(k) - (k == 0 ? kBeyondEndMm : 0);
      const double high_mm =
          options.begin_mm(k) + options.scan_mm() + (k == options.scans - 1 ? kBeyondEndMm : 0);
      scan.grid = std::make_shared<const RangeGrid>(cut(scan, low_mm, high_mm));
      rows[set].push_back(std::move(scan));
    }
  }
  return rows;
}

}  // namespace dubsar::bench
