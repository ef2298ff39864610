// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// What a session says of a scan beside where it lies.
struct ScanEntry {
  int id = 0;
  std::string file{};      ///< its original name, or empty
  std::string when{};      ///< "2026-01-02T03:04:05Z"; empty where nothing tells
  bool by_device = false;  ///< `when` is its first profile, as its device says; else when it was stored: it
                           ///< told none, or one that cannot be
  bool taken_out = false;
  std::string why{};  ///< it was taken out, or empty
};

/// "2026-11-27, 23:07 to 23:08 UTC", from the first scan to the last, those that were taken out too; with
/// what tells it, where that is not the device. Empty where nothing tells.
[[nodiscard]] std::string scanned_in_words(const std::vector<ScanEntry>& scans);

/// "scan 3 (dust), scan 7 (no reason was given)"; empty where none was taken out.
[[nodiscard]] std::string taken_out_in_words(const std::vector<ScanEntry>& scans);

}  // namespace dubsar
