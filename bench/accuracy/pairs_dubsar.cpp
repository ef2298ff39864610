// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/pairs_dubsar.h"

#include "registration/align_near.h"

namespace dubsar::bench {

PairMethod dubsar_method(const std::vector<PublishedScan>& scans) {
  const double before_s = cpu_s();
  ScanSurfaceOptions options;
  options.scale_mm = surface_scale_mm(*scans.front().grid);
  auto surfaces = std::make_shared<std::vector<std::shared_ptr<const ScanSurface>>>();
  for (const PublishedScan& scan : scans) {
    surfaces->push_back(make_scan_surface(*scan.grid, {}, options));
  }
  const double prepare_ms = 1e3 * (cpu_s() - before_s) / static_cast<double>(scans.size());
  return {"Dubsar", prepare_ms, [surfaces](std::size_t on, std::size_t moved, const RigidTransform& start) {
            const ModelScan target{(*surfaces)[on].get(), {}};
            const auto fits = align_near(*(*surfaces)[moved], {&target, 1}, start, {});
            return fits.empty() ? start : fits.front().model_from_scanner;
          }};
}

}  // namespace dubsar::bench
