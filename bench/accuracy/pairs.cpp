// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-pairs FOLDER: registers pairs of real scans from starts that are off, and prints how many of them
// come within half a degree and half a millimetre of the published pose, with the CPU time of a pair on one
// core. The peers that CMake found stand in the same table.
// dubsar-pairs --simulated N: whether the covariance of a pair is what it claims.

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/accuracy/pairs_dubsar.h"
#include "bench/accuracy/pairs_simulated.h"
#include "bench/accuracy/peers.h"
#include "bench/support/options.h"
#include "bench/support/pair_cases.h"
#include "core/units.h"

int main(int argc, char** argv) {
  using namespace dubsar;
  CLI::App app("Pairs of scans from starts that are off", "dubsar-pairs");
  std::string folder;
  std::string conf = "bun.conf";
  std::string unit = "m";
  double least_overlap = 0.3;
  int starts = 4;
  std::uint64_t seed = 1;
  bool peers = false;
  bool verbose = false;
  int simulated = 0;
  app.add_option("folder", folder, "of the scans and their .conf");
  app.add_option(
      "--simulated", simulated,
      "instead: so many simulated tablets of each kind, and whether covariances are what they claim");
  app.add_option("--conf", conf, "published poses, in the folder");
  app.add_option("--unit", unit, "of the scans and the .conf")->check(bench::one_of(kLengthUnits));
  app.add_option("--least-overlap", least_overlap, "of a pair, over the smaller scan");
  app.add_option("--starts", starts, "of each class, for each pair");
  app.add_option("--seed", seed);
  app.add_flag("--peers", peers, "the other libraries as well, where they were found");
  app.add_flag("--verbose", verbose, "the pairs, and what failed");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  if (simulated > 0) {
    bench::print_simulated_pairs(simulated, seed);
    return 0;
  }
  if (folder.empty()) {
    std::fprintf(stderr, "dubsar-pairs: name the folder of the scans, or --simulated N\n");
    return 2;
  }
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const auto scans = bench::read_published(folder, conf, mm_per_unit(unit).value_or(1.0));
  const auto pairs = bench::overlapping_pairs(scans, least_overlap);
  std::vector<bench::PairMethod> methods{bench::dubsar_method(scans)};
  if (peers) {
#ifdef DUBSAR_HAS_PCL
    const auto pcl = bench::pcl_methods(scans);
    methods.insert(methods.end(), pcl.begin(), pcl.end());
#endif
#ifdef DUBSAR_HAS_OPEN3D
    const auto open3d = bench::open3d_methods(scans);
    methods.insert(methods.end(), open3d.begin(), open3d.end());
#endif
  }
  bench::print_pair_table(scans, pairs, methods, starts, seed, verbose);
  return 0;
}
