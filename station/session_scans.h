// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "archive/scan_entries.h"

namespace dubsar {

/// When each scan was stored, by its id, as the session wrote it down: "2026-01-02T03:04:05Z". Without those
/// that were taken in later, of which nobody knows when they were scanned.
[[nodiscard]] std::map<int, std::string> stored_times(const SessionStore& store);

/// All scans of the session, by id. `when` is by the device's time stamp, else by stored_times().
[[nodiscard]] std::vector<ScanEntry> scan_entries_of(const SessionStore& store);

/// The devices that the scans name, in one line each; "" among them where some name none.
[[nodiscard]] std::set<std::string> devices_of_scans(const SessionStore& store);

}  // namespace dubsar
