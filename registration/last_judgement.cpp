// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/last_judgement.h"

#include <algorithm>

namespace dubsar {

bool LastJudgement::Seen::is(const PlacedSurface& placed) const {
  return surface.lock() == placed.surface &&
         model_from_scanner.rotation == placed.model_from_scanner.rotation &&
         model_from_scanner.translation_mm == placed.model_from_scanner.translation_mm;
}

bool LastJudgement::is_of(const PlacedSurface& scan, std::span<const PlacedSurface> others) const {
  return !seen_.empty() && seen_.front().is(scan) &&
         std::equal(seen_.begin() + 1, seen_.end(), others.begin(), others.end(),
                    [](const Seen& seen, const PlacedSurface& other) { return seen.is(other); });
}

const ModelFit& LastJudgement::of(const PlacedSurface& scan, std::span<const PlacedSurface> others,
                                  const ModelFitOptions& options) {
  if (!is_of(scan, others)) {
    fit_ = judge_in_model(*scan.surface, model_scans(others), scan.model_from_scanner, options);
    seen_.assign(1, {scan.surface, scan.model_from_scanner});
    for (const PlacedSurface& other : others) {
      seen_.push_back({other.surface, other.model_from_scanner});
    }
  }
  return fit_;
}

std::vector<ModelScan> model_scans(std::span<const PlacedSurface> placed) {
  std::vector<ModelScan> out;
  out.reserve(placed.size());
  for (const PlacedSurface& p : placed) {
    out.push_back({p.surface.get(), p.model_from_scanner});
  }
  return out;
}

}  // namespace dubsar
