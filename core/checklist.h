// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/red_map.h"

namespace dubsar {

struct FaceCoverage {
  double seen_mm2 = 0;  ///< meshed surface of this face
  double red_mm2 = 0;   ///< estimated area still missing
  double excused_mm2 = 0;
};

/// What an operator signs before the tablet goes back into its box.
struct Checklist {
  std::array<FaceCoverage, kFaceCount> faces{};  ///< by Face
  int scans_registered = 0;
  int scans_unsure = 0;
  int scans_failed = 0;
  std::string calibration;  ///< empty when the device told none
  std::optional<double> calibration_age_days;
  double disk_free_gib = 0;
  bool store_whole = false;  ///< every stored byte matched its checksum
  bool conclusive = false;
};

}  // namespace dubsar
