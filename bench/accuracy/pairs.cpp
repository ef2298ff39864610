// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support/pair_cases.h"
#include "registration/align_near.h"

int main(int argc, char** argv) {
  using namespace dubsar;
  CLI::App app("pairs", "dubsar-pairs");
  std::string folder;
  double least = 0.2;
  int starts = 4;
  bool verbose = false;
  app.add_option("folder", folder)->required();
  app.add_option("--least", least);
  app.add_option("--starts", starts);
  app.add_flag("--verbose", verbose);
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto scans = bench::read_published(folder, "bun.conf", 1000.0);
  const auto pairs = bench::overlapping_pairs(scans, least);
  for (const auto& pair : pairs) {
    const RigidTransform turn{pair.on_from_moved.rotation, {0, 0, 0}};
    std::printf("%s onto %s overlap %.2f  %.0f deg\n", scans[pair.moved].name.c_str(),
                scans[pair.on].name.c_str(), pair.overlap, turn.angle_rad() * 57.2958);
  }
  std::vector<std::shared_ptr<const ScanSurface>> surfaces;
  const double before = bench::cpu_s();
  ScanSurfaceOptions surface;
  surface.scale_mm = surface_scale_mm(*scans[0].grid);
  for (const auto& scan : scans) {
    surfaces.push_back(make_scan_surface(*scan.grid, {}, surface));
  }
  const double prepare = 1e3 * (bench::cpu_s() - before) / static_cast<double>(scans.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const auto& s = *surfaces[k];
    std::printf("%s valid %zu spacing %.3f noise %.3f extent %.1f scale %.1f levels %.2f %.2f %.2f\n", scans[k].name.c_str(), s.valid, s.spacing_mm, s.noise_mm, s.extent_mm, s.scale_mm, s.fine->spacing_mm, s.medium->spacing_mm, s.coarse->spacing_mm);
  }
  bench::PairMethod model{"fit_to_model", prepare, [&](std::size_t on, std::size_t moved, const RigidTransform& start) {
    const ModelScan target{surfaces[on].get(), {}};
    const auto fits = fit_to_model(*surfaces[moved], {&target, 1}, {&start, 1}, {});
    return fits.empty() ? start : fits.front().model_from_scanner;
  }};
  bench::PairMethod near{"align_near", prepare, [&](std::size_t on, std::size_t moved, const RigidTransform& start) {
    const ModelScan target{surfaces[on].get(), {}};
    const auto fits = align_near(*surfaces[moved], {&target, 1}, start, {});
    return fits.empty() ? start : fits.front().model_from_scanner;
  }};
  bench::print_pair_table(scans, pairs, {model, near}, starts, 1, verbose);
  return 0;
}
