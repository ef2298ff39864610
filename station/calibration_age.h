// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "core/checklist.h"

namespace dubsar {

/// How many days the calibration of a checklist is old now: since its date, where the checklist tells one.
/// Else what the device said of it when it was opened, and the days since the session's last scan was stored
/// (`last_scan`, ISO 8601 in UTC; empty: not known), which is no more than a run longer ago. Nothing where
/// the device told no age.
[[nodiscard]] std::optional<double> calibration_age_now(const Checklist& list, const std::string& last_scan);

}  // namespace dubsar
