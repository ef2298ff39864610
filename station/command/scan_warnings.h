// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fmt/format.h>

#include <vector>

#include "core/checklist.h"
#include "core/log.h"

namespace dubsar {

/// What is wrong with scans that are in the model all the same: whoever signs is to have read it.
inline void log_scan_warnings(const std::vector<ScanWarning>& warnings) {
  for (const ScanWarning& warning : warnings) {
    log_warning(fmt::format("scan {}: {}", warning.scan, warning.text));
  }
}

}  // namespace dubsar
