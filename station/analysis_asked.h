// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/surface_fields.h"
#include "core/wedge_correction.h"
#include "station/analysis.h"

namespace dubsar {

/// What an analysis of a mesh is asked for and writes, as its stamp remembers it. Paths as they are opened;
/// empty: not asked for.
struct AnalysisAsked {
  std::string out;  ///< wedges.json
  std::string mesh_out;
  std::string exits = "surface";  ///< or "extent"
  std::string unit;               ///< of kLengthUnits; empty: the file's own, or what its size tells
  std::string pictures;
  std::string invariants;
  double radius_mm = 1.0;  ///< of the invariants
  SurfaceFieldOptions fields;
  bool uniform_weights = false;
  std::string svg;
  bool classical = false;  ///< the textbook watershed
};

[[nodiscard]] AnalysisOptions options_of(const AnalysisAsked& asked,
                                         std::vector<WedgeCorrection> corrections);

/// Fills what the operator has not `said` ("--exit") in with what the wedges in asked.out were found
/// with, as the stamp beside them tells: else a correction would measure them by other rules, and leave
/// drawings behind that show what was deleted. Without a stamp the file's own word on the exits.
void take_known_options(AnalysisAsked& asked, const std::function<bool(const char*)>& said);

}  // namespace dubsar
