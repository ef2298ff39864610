// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/calibration_age.h"

#include <string_view>

#include "acquisition/rig_scan.h"

namespace dubsar {

namespace {

/// When a rig's calibration was made, as RigScanner::make() writes it into Rig::calibration behind the file;
/// empty where another device says something else.
std::string made_at(const std::string& calibration) {
  constexpr std::string_view kMade = ", made ";
  const std::size_t at = calibration.rfind(kMade);
  const std::string rest = at == std::string::npos ? "" : calibration.substr(at + kMade.size());
  return rest.substr(0, rest.find(' '));
}

}  // namespace

std::optional<double> calibration_age_now(const Checklist& list, const std::string& last_scan) {
  if (!list.calibration_age_days) {
    return std::nullopt;
  }
  if (const auto since_made = days_since(made_at(list.calibration))) {
    return since_made;
  }
  return *list.calibration_age_days + days_since(last_scan).value_or(0.0);
}

}  // namespace dubsar
