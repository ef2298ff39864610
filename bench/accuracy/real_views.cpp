// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Real scans with published poses, taken in order: after each, the share of red that the program predicts
// every remaining scan to clear, and all of them together, against what they do clear.
//   dubsar-real-views --set FOLDER CONF [--set FOLDER CONF …] [--unit-mm 1000]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "bench/support/options.h"
#include "bench/support/pair_cases.h"
#include "core/grid_noise.h"
#include "planning/cleared_map.h"
#include "planning/next_view.h"
#include "planning/red_change.h"
#include "planning/red_map.h"
#include "planning/sparse_flags.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Shares {
  std::vector<double> predicted, actual;
};

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) {
      ++j;
    }
    for (std::size_t k = i; k < j; ++k) {
      rank[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    }
    i = j;
  }
  return rank;
}

/// Spearman's rank correlation.
double rank_correlation(const Shares& shares) {
  const std::vector<double> a = ranks(shares.predicted);
  const std::vector<double> b = ranks(shares.actual);
  const auto n = static_cast<double>(a.size());
  const double mean = 0.5 * (n - 1);
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean) * (b[i] - mean);
    aa += (a[i] - mean) * (a[i] - mean);
    bb += (b[i] - mean) * (b[i] - mean);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0.0;
}

void judge(const std::vector<PublishedScan>& scans, Shares& each, Shares& together) {
  JobContext job;
  ClearedMap cleared;
  std::vector<SampleFlags> flags;
  for (const PublishedScan& scan : scans) {
    flags.push_back(flag_sparse(*scan.grid));
  }
  const auto placed = [&](std::size_t k) {
    return PlacedScan{static_cast<int>(k), scans[k].grid.get(), &flags[k], scans[k].model_from_scanner, 0.1};
  };
  for (std::size_t k = 0; k + 1 < scans.size(); ++k) {
    cleared.add(placed(k));
    const std::vector<PlacedScan> so_far = cleared.scans();
    const auto red = make_red_map(so_far, nullptr, nullptr, {}, job);
    if (!red) {
      return;
    }
    const ModelSurface surface = model_surface(so_far);
    const std::vector<RedTarget>& targets = red->targets.targets;
    double all = 0;
    for (const RedTarget& t : targets) {
      all += t.state == RegionState::kRed ? t.area_mm2 : 0.0;
    }
    std::vector<double> missed(targets.size(), 1.0);
    std::vector<std::uint8_t> done(targets.size(), 0);
    for (std::size_t j = k + 1; j < scans.size(); ++j) {
      ViewCandidate candidate;
      candidate.model_from_scanner = scans[j].model_from_scanner;
      const auto chances = clearing_chances(
          candidate, ScannerModel::of(*scans[j].grid, estimate_noise_mm(*scans[j].grid)), surface, targets);
      double predicted = 0;
      for (std::size_t i = 0; i < targets.size(); ++i) {
        predicted += chances[i] * targets[i].area_mm2;
        missed[i] *= 1.0 - chances[i];
      }
      const std::vector<std::uint8_t> now = cleared_targets(red->targets, placed(j));
      double actual = 0;
      for (std::size_t i = 0; i < targets.size(); ++i) {
        actual += now[i] != 0 ? targets[i].area_mm2 : 0.0;
        done[i] |= now[i];
      }
      each.predicted.push_back(predicted / all);
      each.actual.push_back(actual / all);
    }
    double predicted = 0;
    double actual = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const bool is_red = targets[i].state == RegionState::kRed;
      predicted += is_red ? (1.0 - missed[i]) * targets[i].area_mm2 : 0.0;
      actual += done[i] != 0 ? targets[i].area_mm2 : 0.0;
    }
    together.predicted.push_back(predicted / all);
    together.actual.push_back(actual / all);
    std::printf("  after %-28s red %9.1f mm2; all remaining together: predicted %5.1f %%, actual %5.1f %%\n",
                scans[k].name.c_str(), all, 100 * predicted / all, 100 * actual / all);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::pair<std::string, std::string>> sets;
  double mm_per_unit = 1000;
  CLI::App app("predicted against actual clearing on real scans");
  app.add_option("--set", sets, "folder of range grids, and their published poses")->required();
  app.add_option("--unit-mm", mm_per_unit, "millimetres per unit of the files");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  Shares each;
  Shares together;
  for (const auto& [folder, conf] : sets) {
    std::printf("%s\n", conf.c_str());
    judge(read_published(folder, conf, mm_per_unit), each, together);
  }
  std::printf(
      "rank correlation over %zu remaining scans one by one: %.3f; over %zu steps, all remaining together: "
      "%.3f\n",
      each.actual.size(), rank_correlation(each), together.actual.size(), rank_correlation(together));
  return 0;
}
