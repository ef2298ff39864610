// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "archive/report.h"
#include "archive/report_pictures.h"

namespace dubsar {

/// The parts of the report, each an HTML section (or nothing when there is nothing to say).
[[nodiscard]] std::string verdict_section(const ReportInput& input);
[[nodiscard]] std::string next_section(const ReportInput& input);
[[nodiscard]] std::string checklist_section(const ReportInput& input);
[[nodiscard]] std::string sign_off_section(const ReportInput& input);
[[nodiscard]] std::string regions_section(const ReportInput& input, const ReportPictures& pictures);
[[nodiscard]] std::string red_sheet_section(const ReportPictures& pictures);
[[nodiscard]] std::string scans_section(const ReportInput& input);
[[nodiscard]] std::string accuracy_section(const ReportInput& input);
/// Nothing without a sentence on them.
[[nodiscard]] std::string wedges_section(const std::string& sentence,
                                         const std::vector<WedgeProfile>& profiles);
[[nodiscard]] std::string not_measured_section(const ReportInput& input);
[[nodiscard]] std::string timings_section(const ReportInput& input);

/// Everything before the first section, and after the last. `kind` names the page in its title and, as
/// `kicker`, over its heading.
[[nodiscard]] std::string page_head(const ReportInput& input, const std::string& kind,
                                    const std::string& kicker);
[[nodiscard]] std::string page_foot();

[[nodiscard]] RegionSum sum_of(const RedMap& map, RegionState state);

/// Conclusive only when the red map and the checklist both say so.
[[nodiscard]] bool is_conclusive(const ReportInput& input);

}  // namespace dubsar
