// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "archive/report.h"

namespace dubsar {

/// The parts of the report, each an HTML section (or nothing when there is nothing to say).
[[nodiscard]] std::string verdict_section(const ReportInput& input);
[[nodiscard]] std::string next_section(const ReportInput& input);
[[nodiscard]] std::string checklist_section(const ReportInput& input);
[[nodiscard]] std::string regions_section(const ReportInput& input);
[[nodiscard]] std::string scans_section(const ReportInput& input);
[[nodiscard]] std::string accuracy_section(const ReportInput& input);
[[nodiscard]] std::string not_measured_section(const ReportInput& input);
[[nodiscard]] std::string timings_section(const ReportInput& input);

/// Sums over the red map's regions of one state.
struct RegionSum {
  long long count = 0;
  double area_mm2 = 0;
};
[[nodiscard]] RegionSum sum_of(const RedMap& map, RegionState state);

/// Conclusive only when the red map and the checklist both say so.
[[nodiscard]] bool is_conclusive(const ReportInput& input);

}  // namespace dubsar
