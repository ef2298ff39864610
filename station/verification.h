// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "acquisition/artefact.h"
#include "core/job.h"
#include "core/result.h"
#include "formats/verification_log.h"

namespace dubsar {

struct VerifyRequest {
  std::string artefact;  ///< artefact.toml
  std::string scan;      ///< of the artefact: a file with one scan, or a device that takes it
  /// That is verified, or the rig.toml of a range camera; the outcome goes into the log beside it. Empty:
  /// into none.
  std::string calibration;
};

struct VerifyOutcome {
  Artefact artefact;
  Verification is;
  VerificationEntry entry;
  std::string log;              ///< that it was written into; empty: none
  bool time_unknown = false;    ///< the file does not say when it was scanned: the entry has the time of now
  bool camera_unknown = false;  ///< the file does not say which camera scanned it, and the calibration does
};

/// Measures a certified artefact in one scan and judges it by its certificate. One that fails is an outcome,
/// and is logged like one that passes. A scan that says another camera than the calibration, or a time before
/// it was made, is refused. Errors: kUsage, kBadInput, kDevice, kStorage, kCancelled.
[[nodiscard]] Result<VerifyOutcome> verify_rig(const VerifyRequest& request, JobContext& job);

/// The figures as the log and `--json` have them.
[[nodiscard]] nlohmann::ordered_json verification_figures(const Verification& is);

/// A rig is measured every day that it is used.
inline constexpr double kVerifyEveryDays = 1.0;

/// What a station says of its rig before it is used.
struct RigCare {
  std::string verified;                   ///< file, beside which the log lies
  std::string calibration;                ///< the same, where it is one; empty: of a range camera
  std::optional<VerificationEntry> last;  ///< of the rig as it stands
  std::optional<double> age_days;         ///< of it
  /// Nothing was measured with the rig as it stands, or too long ago, or it failed.
  [[nodiscard]] bool is_due() const {
    return !last || !last->passed || !age_days || *age_days > kVerifyEveryDays;
  }
};

/// The file that turns a rig's pictures into millimetres, as it stands.
struct CalibrationFile {
  std::filesystem::path path;
  std::string json;     ///< all of it (docs/formats/calibration.md)
  std::string made_at;  ///< ISO 8601, UTC
};

/// Of a device "rig:FILE"; nothing for another device, or a file that cannot be read (opening it says why).
[[nodiscard]] std::optional<CalibrationFile> calibration_file_of(const std::string& device_uri);
[[nodiscard]] std::optional<RigCare> care_of(const std::string& device_uri);

}  // namespace dubsar
