// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/scan_entries.h"

#include <algorithm>
#include <cstddef>

namespace dubsar {

namespace {

constexpr std::size_t kDay = 10;    ///< characters of "2026-11-27"
constexpr std::size_t kMinute = 5;  ///< of "23:07"

std::string day_of(const std::string& when) {
  return when.substr(0, kDay);
}
std::string minute_of(const std::string& when) {
  return when.size() > kDay ? when.substr(kDay + 1, kMinute) : std::string();
}

}  // namespace

std::string scanned_in_words(const std::vector<ScanEntry>& scans) {
  std::string first;
  std::string last;
  bool by_device = true;
  for (const ScanEntry& scan : scans) {
    if (scan.when.empty()) {
      continue;
    }
    first = first.empty() ? scan.when : std::min(first, scan.when);
    last = std::max(last, scan.when);
    by_device = by_device && scan.by_device;
  }
  if (first.empty()) {
    return {};
  }
  std::string words = day_of(first) + ", " + minute_of(first);
  if (day_of(first) != day_of(last)) {
    words += " to " + day_of(last) + ", " + minute_of(last);
  } else if (minute_of(first) != minute_of(last)) {
    words += " to " + minute_of(last);
  }
  return words + " UTC" + (by_device ? "" : ", by when the session stored what came without a time");
}

std::string taken_out_in_words(const std::vector<ScanEntry>& scans) {
  std::string words;
  for (const ScanEntry& scan : scans) {
    if (scan.taken_out) {
      words += (words.empty() ? "" : ", ") + ("scan " + std::to_string(scan.id)) + " (" +
               (scan.why.empty() ? "no reason was given" : scan.why) + ")";
    }
  }
  return words;
}

}  // namespace dubsar
