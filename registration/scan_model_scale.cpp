// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What size the object is, by which levels and descriptors are scaled and wrong units are told.
#include <algorithm>
#include <utility>

#include "registration/scan_model.h"

namespace dubsar {

void ScanModel::give_surface(Scan& scan, std::shared_ptr<const ScanSurface> surface, const ScanSize& size,
                             const ScanSize& before) {
  scan.features = make_scan_features(std::move(surface), options_.search.align);
  scan.suspicion = perhaps_other_unit(size, before);
  scan.own_spacing_mm = size.spacing_mm;
  scan.usable = scan.features.surface->fine->samples.size() >= options_.least_samples;
  scan.reason = scan.usable ? ""
                            : "too few of its samples can be matched; scan it again, nearer or with more of "
                              "the surface in view";
}

void ScanModel::let_waiting_in(const ScanSize& now) {
  ScanSurfaceOptions surface = options_.surface;
  surface.scale_mm = now.scale_mm;
  for (auto& [id, scan] : scans_) {
    if (!scan.waiting) {
      continue;
    }
    const ScanSize size{scan.own_scale_mm, scan.waiting->spacing_mm};
    if (sizes_agree(size, now, options_.most_unit_ratio)) {
      give_surface(scan, rescaled(*std::exchange(scan.waiting, nullptr), surface), size, now);
    } else {
      scan.reason = other_unit(size, now);
    }
  }
}

void ScanModel::rescale(double scale_mm) {
  scale_mm_ = scale_mm;
  ScanSurfaceOptions surface = options_.surface;
  surface.scale_mm = scale_mm;
  for (auto& [id, scan] : scans_) {
    scan.self_similar.reset();
    scan.relief_repeats.reset();
    scan.tried_on.clear();
    if (scan.features.surface) {
      scan.features = make_scan_features(rescaled(whole_of(id), surface), options_.search.align);
      scan.whole.reset();
      scan.left_out.clear();
    }
  }
}

void ScanModel::settle_scale(JobContext& job) {
  const auto larger_of = [](const Scan* a, const Scan& b) {
    return a == nullptr || b.own_scale_mm > a->own_scale_mm ? &b : a;
  };
  const Scan* largest = nullptr;
  const Scan* largest_waiting = nullptr;
  bool one_is_as_large = false;
  for (const auto& [id, scan] : scans_) {
    if (scan.usable) {
      largest = larger_of(largest, scan);
      one_is_as_large = one_is_as_large || (scan.own_scale_mm <= kMuchLarger * scale_mm_ &&
                                            scale_mm_ <= kMuchLarger * scan.own_scale_mm);
    } else if (scan.waiting) {
      largest_waiting = larger_of(largest_waiting, scan);
    }
  }
  if (one_is_as_large) {
    return;
  }
  const ScanSize now = largest != nullptr ? ScanSize{largest->own_scale_mm, largest->own_spacing_mm}
                       : largest_waiting != nullptr
                           ? ScanSize{largest_waiting->own_scale_mm, largest_waiting->waiting->spacing_mm}
                           : ScanSize{0, 0};
  scale_mm_ = now.scale_mm;
  first_spacing_mm_ = now.spacing_mm;
  for (auto& [id, scan] : scans_) {
    scan.suspicion = perhaps_other_unit({scan.own_scale_mm, scan.own_spacing_mm}, now);
  }
  if (now.scale_mm > 0) {
    rescale(now.scale_mm);
    let_waiting_in(now);
    retry(job);
  }
}

}  // namespace dubsar
