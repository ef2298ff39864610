// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_scans.h"

#include <cstdint>
#include <ctime>
#include <nlohmann/json.hpp>

#include "core/utf8.h"
#include "formats/json_node.h"
#include "station/results.h"

namespace dubsar {

namespace {

constexpr const char* kScanStored = "scan stored";

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::string utc_of(std::int64_t time_ns) {
  return utc_text(static_cast<std::time_t>(time_ns / kNanosecondsPerSecond));
}

/// Whether a device can have told this time of a scan that was stored then: no clock that counts from its own
/// start, and none that is ahead, but for the hours by which clocks of different places differ.
bool is_likely(std::int64_t time_ns, const std::string& stored) {
  constexpr std::int64_t kDay_ns = 86400 * kNanosecondsPerSecond;
  constexpr std::int64_t kFirstScanners_ns = 3652 * kDay_ns;  // 1980
  return time_ns >= kFirstScanners_ns && (stored.empty() || utc_of(time_ns - kDay_ns) <= stored);
}

}  // namespace

std::map<int, std::string> stored_times(const SessionStore& store) {
  std::map<int, std::string> times;
  const auto events = store.events();
  for (const SessionEvent& event : events ? *events : std::vector<SessionEvent>()) {
    if (event.kind != kScanStored || event.time_ns <= 0 || json_depth(event.json) > kMaxJsonDepth) {
      continue;
    }
    const auto what = nlohmann::json::parse(event.json, nullptr, false);
    if (what.is_object() && what.contains("id") && what["id"].is_number_integer()) {
      times.emplace(what["id"].get<int>(), utc_of(event.time_ns));
    }
  }
  return times;
}

std::vector<ScanEntry> scan_entries_of(const SessionStore& store) {
  std::vector<ScanEntry> entries;
  const auto scans = store.scans();
  const std::map<int, std::string> stored = stored_times(store);
  for (const StoredScan& scan : scans ? *scans : std::vector<StoredScan>()) {
    ScanEntry& entry = entries.emplace_back();
    entry.id = scan.id;
    entry.file = scan.source;
    entry.taken_out = scan.dropped;
    entry.why = scan.dropped ? scan.note : std::string();
    const auto at = stored.find(scan.id);
    const std::string kept = at == stored.end() ? std::string() : at->second;
    entry.by_device = is_likely(scan.timestamp_ns, kept);
    entry.when = entry.by_device ? utc_of(scan.timestamp_ns) : kept;
  }
  return entries;
}

std::set<std::string> devices_of_scans(const SessionStore& store) {
  std::set<std::string> devices;
  const auto scans = store.scans();
  for (const StoredScan& scan : scans ? *scans : std::vector<StoredScan>()) {
    devices.insert(one_line(scan.device));
  }
  return devices;
}

}  // namespace dubsar
