// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/pairs_simulated.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "bench/support/true_scans.h"
#include "core/random.h"
#include "registration/model_fit.h"
#include "registration/pair_fit.h"

namespace dubsar::bench {

namespace {

struct Sums {
  std::vector<double> squares;  ///< normalised errors per degree of freedom
  double across2_mm2 = 0;       ///< mean square displacement across the surface, summed over the pairs
  int slid = 0, none = 0;
};

/// The truth, off by about what a fit to the model leaves.
RigidTransform near_truth(const RigidTransform& truth, const ScanSurface& moved, double sigma_mm,
                          Random& random) {
  const RigidTransform turn =
      RigidTransform::from_twist(sigma_mm / moved.extent_mm * random.normal3(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d center = truth * moved.centroid_mm;
  return {turn.rotation * truth.rotation,
          turn.rotation * (truth.translation_mm - center) + center + sigma_mm * random.normal3()};
}

void measure(const TrueScan& a, const TrueScan& b, const ScanSurface& on, const ScanSurface& moved,
             Random& random, Sums& sums) {
  const RigidTransform truth = a.tablet_from_scanner.inverse() * b.tablet_from_scanner;
  const double sigma_mm = residual_sigma_mm(on, moved, {});
  const auto fit = fit_pair(on, moved, near_truth(truth, moved, sigma_mm, random), sigma_mm);
  if (!fit || fit->slid) {
    sums.none += fit ? 0 : 1;
    sums.slid += fit ? 1 : 0;
    return;
  }
  const RigidTransform off = fit->on_from_moved * truth.inverse();
  const Eigen::Vector3d center = truth * (fit->on_from_moved.inverse() * fit->center_mm);
  const Eigen::AngleAxisd turn(off.rotation);
  Vector6d error;
  error << turn.angle() * turn.axis(), off * center - center;
  sums.squares.push_back(error.dot(fit->information * error) / 6.0);
  double across2 = 0;
  for (const SurfaceSample& sample : moved.fine->samples) {
    const Eigen::Vector3d p = truth * Eigen::Vector3d(sample.position_mm.cast<double>());
    const Eigen::Vector3d n = truth.rotation * Eigen::Vector3d(sample.normal.cast<double>());
    across2 += std::pow(n.dot(off * p - p), 2.0);
  }
  sums.across2_mm2 += across2 / static_cast<double>(moved.fine->samples.size());
}

}  // namespace

void print_simulated_pairs(int tablets, std::uint64_t first_seed) {
  std::printf("%-6s %8s %7s %6s %5s %5s %9s %9s %9s %12s\n", "kind", "spacing", "noise", "pairs", "slid",
              "none", "NEES/dof", "median", "largest", "across um");
  double all = 0;
  std::size_t count = 0;
  for (const double spacing_mm : {0.1, 0.2}) {
    for (const double noise_mm : {0.01, 0.03}) {
      for (const char* kind : {"text", "blank", "worn", "tiny"}) {
        Sums sums;
        for (int t = 0; t < tablets; ++t) {
          const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(t);
          const auto scans =
              true_scans(random_tablet(seed, kind, 0.1),
                         {spacing_mm, noise_mm, 12, {0, 2, 4, 6, 8, 10}, seed, Pins::kNone, 0});
          ScanSurfaceOptions options;
          options.scale_mm = surface_scale_mm(*scans.front().grid);
          std::vector<std::shared_ptr<const ScanSurface>> surfaces;
          for (const TrueScan& scan : scans) {
            surfaces.push_back(make_scan_surface(*scan.grid, {}, options));
          }
          Random random(seed_for(seed, 7));
          for (std::size_t a = 0; a < scans.size(); ++a) {
            for (std::size_t b = a + 1; b < scans.size(); ++b) {
              measure(scans[a], scans[b], *surfaces[a], *surfaces[b], random, sums);
            }
          }
        }
        double sum = 0;
        for (const double s : sums.squares) {
          sum += s;
        }
        all += sum;
        count += sums.squares.size();
        std::sort(sums.squares.begin(), sums.squares.end());
        const double n = std::max(1.0, static_cast<double>(sums.squares.size()));
        std::printf("%-6s %8.2f %7.3f %6zu %5d %5d %9.2f %9.2f %9.1f %12.2f\n", kind, spacing_mm, noise_mm,
                    sums.squares.size(), sums.slid, sums.none, sum / n,
                    sums.squares.empty() ? 0.0 : sums.squares[sums.squares.size() / 2],
                    sums.squares.empty() ? 0.0 : sums.squares.back(), 1e3 * std::sqrt(sums.across2_mm2 / n));
        std::fflush(stdout);
      }
    }
  }
  std::printf("all: %zu pairs, normalised squared error %.2f per degree of freedom\n", count,
              all / std::max(1.0, static_cast<double>(count)));
}

}  // namespace dubsar::bench
