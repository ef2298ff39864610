// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"
#include "formats/verification_log.h"

namespace dubsar {

/// Where the verifications of a rig are kept, and which of them are of the rig as it stands.
struct RigLog {
  std::filesystem::path verified;  ///< calibration.json, or the rig.toml of a range camera, which has none
  std::filesystem::path log;       ///< beside it
  /// What a line says as `calibration`: when the calibration was made; of a range camera which one it is and
  /// how the stage moves it.
  std::string as_it_stands;
  std::string camera_serial;  ///< of the calibration; empty where nobody says
  std::string rig_name;       ///< of the rig.toml; empty where a calibration was named

  [[nodiscard]] bool of_range_camera() const { return verified.extension() == ".toml"; }
  /// Of the lines, if the last one is of the rig as it stands: the one whose scan is the latest, of those of
  /// one scan the last; the last line where that says no time. A log that cannot be read says nothing.
  [[nodiscard]] std::optional<VerificationEntry> last() const;
};

/// The FILE.toml of a device "rig:FILE.toml"; nothing for another device.
[[nodiscard]] std::optional<std::filesystem::path> rig_file_of(const std::string& device_uri);

/// `file`: a calibration, or a rig.toml. Errors: kBadInput, kStorage.
[[nodiscard]] Result<RigLog> rig_log_of(const std::filesystem::path& file);

}  // namespace dubsar
