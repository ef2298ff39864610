// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/red_map.h"
#include "core/rig.h"
#include "core/sign_off.h"

namespace dubsar {

/// Median and 95th percentile over the surface; infinite where no scan sampled so much of it well.
struct Spread {
  double median = std::numeric_limits<double>::infinity();
  double p95 = std::numeric_limits<double>::infinity();
};

/// How well a stretch of surface was sampled (docs/scholars/measurements.md, "How well the surface was
/// sampled"). Shares are of the surface, in [0, 1]; all zero without any.
struct SamplingQuality {
  std::int64_t places = 0;       ///< that were looked at, spread evenly over the surface
  Spread spacing_mm;             ///< on the surface, of the samples of all scans together
  double fine_share = 0;         ///< of the surface with such a spacing of at most kFineSpacingMm
  Spread single_spacing_mm;      ///< on the surface, along the coarser direction of the best single scan
  double single_fine_share = 0;  ///< likewise
  Spread incidence_rad;          ///< best angle between the normal and the worse of laser and camera
  static constexpr std::size_t kAngleBins = 9;
  std::array<double, kAngleBins> incidence_share{};  ///< by 10 degrees, [0, 10), … [80, 90]
  static constexpr std::size_t kScanBins = 6;
  std::array<double, kScanBins> scans_share{};  ///< sampled well by 0, 1, 2, 3, 4, 5 and more scans
};

/// 25 µm: the spacing that cuneiform wants (seed 001).
inline constexpr double kFineSpacingMm = 0.025;

struct FaceCoverage {
  double seen_mm2 = 0;          ///< measured mesh of this face
  double interpolated_mm2 = 0;  ///< mesh that fills small gaps
  double red_mm2 = 0;           ///< estimated area still missing
  double excused_mm2 = 0;
  std::vector<double> red_regions_mm2;      ///< largest first
  std::vector<double> excused_regions_mm2;  ///< likewise; strays, which lack no surface, are not among them
  SamplingQuality sampling;

  /// Part of what there is to see that was seen, in [0, 1]; 0 where nothing is known of the face.
  [[nodiscard]] double coverage() const {
    const double all_mm2 = seen_mm2 + red_mm2 + excused_mm2;
    return all_mm2 > 0 ? seen_mm2 / all_mm2 : 0.0;
  }
};

/// A region of zero area: returns from nowhere, which are excused since no clay is missing there.
[[nodiscard]] inline bool is_stray(const RedRegion& region) {
  return region.state == RegionState::kExcused && !(region.area_mm2 > 0);
}

/// Regions of a red map together, strays left out.
struct RegionSum {
  long long count = 0;
  double area_mm2 = 0;  ///< by estimate
};

/// Of those for which counts(region).
template <class Counts>
[[nodiscard]] RegionSum sum_of_regions(const RedMap& map, const Counts& counts) {
  RegionSum sum;
  for (const RedRegion& region : map.regions) {
    if (!is_stray(region) && counts(region)) {
      ++sum.count;
      sum.area_mm2 += std::isfinite(region.area_mm2) ? region.area_mm2 : 0.0;
    }
  }
  return sum;
}

/// What is out of the scanner's reach: no verdict speaks of its shape.
[[nodiscard]] inline RegionSum sum_out_of_reach(const RedMap& map) {
  return sum_of_regions(map, [](const RedRegion& region) {
    return region.state == RegionState::kExcused && region.excuse == Excuse::kUnreachable;
  });
}

/// What a person should know of a scan.
struct ScanWarning {
  int scan = 0;  ///< its id
  std::string text;
};

/// What an operator signs before the tablet goes back into its box.
struct Checklist {
  bool conclusive = false;
  std::array<FaceCoverage, kFaceCount> faces{};  ///< by Face
  SamplingQuality sampling;                      ///< of all faces together
  int strays = 0;                                ///< regions of zero area

  int scans_registered = 0;
  int scans_unsure = 0;
  int scans_failed = 0;
  std::vector<int> scans_lost;        ///< ids of those that stand and cannot be read as they were stored
  std::vector<int> scans_unplaced;    ///< ids of those that stand and have no pose yet
  double worst_sigma_mm = 0;          ///< of the registered scans
  int worst_sigma_scan = -1;          ///< its id; -1 when no scan is registered
  std::vector<ScanWarning> warnings;  ///< what is wrong with scans although they are registered
  std::vector<ScanWarning> remarks;   ///< of the devices on the scans that stand

  std::string calibration;                     ///< empty when the device told none
  std::optional<double> calibration_age_days;  ///< when the device was opened
  std::optional<CalibrationCheck> calibration_check;

  double disk_free_gib = 0;
  bool store_whole = false;   ///< every stored byte is there and matched its checksum
  std::string store_checked;  ///< when, ISO 8601, UTC; empty when it was not
  int store_files = 0;        ///< that were read to the end for it

  std::optional<CheckedSignOff> sign_off;  ///< the latest
};

}  // namespace dubsar
