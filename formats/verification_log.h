// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// One measurement of a certified artefact, as the log keeps it.
struct VerificationEntry {
  std::string when;  ///< ISO 8601, UTC
  std::string artefact;
  std::string certificate;
  std::string calibration;  ///< made_at of the calibration that was verified
  double error_mm = 0;      ///< largest deviation from the certificate
  bool passed = false;
  std::vector<std::string> failed;  ///< limits that were not kept
  std::string measured;             ///< a JSON object with every figure
};

/// One JSON object a line, oldest first. A line that cannot be read is left out and counted in `damaged`: the
/// others stand.
struct VerificationLog {
  std::vector<VerificationEntry> entries;
  std::size_t damaged = 0;
};
[[nodiscard]] VerificationLog parse_verification_log(std::string_view text);
/// A log that is not there is an empty one. Errors: a file that cannot be read.
[[nodiscard]] Result<VerificationLog> read_verification_log(const std::filesystem::path& path);
/// Adds a line; what stands there stays byte for byte. Several at the same moment, from threads or programs
/// of one computer, come one after the other. Errors: kStorage.
[[nodiscard]] Status append_verification(const std::filesystem::path& path, const VerificationEntry& entry);

/// Where the log of a calibration lies: calibration.json has calibration.verified.jsonl.
[[nodiscard]] std::filesystem::path verification_log_of(const std::filesystem::path& calibration);

}  // namespace dubsar
