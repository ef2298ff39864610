// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "acquisition/rig_scan.h"
#include "drivers/device.h"
#include "drivers/loader.h"

namespace dubsar {

/// A rig as any other range source: wraps it in the driver interface, in process.
[[nodiscard]] Device device_of(RigScanner scanner, const std::string& uri);

/// A rig's parts, before they are put together: what a calibration is taken with. The calibration need not be
/// there yet. Settings of the camera are put. Errors: kUsage, kBadInput, kDevice.
struct RigParts {
  RigFile file;
  Device camera;
  Device stage;
};
[[nodiscard]] Result<RigParts> open_rig_parts(const std::filesystem::path& file,
                                              const DriverRegistry& registry);

/// Opens `rig:FILE.toml`: reads the file and its calibration, opens camera and stage, puts them together.
/// Errors: kUsage, kBadInput, kDevice.
[[nodiscard]] Result<Device> open_rig(const std::filesystem::path& file, const DriverRegistry& registry);

/// The latest line of a rig's log, if it is of the rig as it stands and was passed: what the checklist shows.
/// Nothing where there is none, or the files cannot be read.
[[nodiscard]] std::optional<CalibrationCheck> last_verification(const std::filesystem::path& rig_file);

/// A rig is verified before each day's work: what to tell the operator when the last verification that was
/// passed is older than a day, there is none of the rig as it stands, or it failed the last one. Nothing for
/// other devices.
[[nodiscard]] std::optional<std::string> verification_reminder(const std::string& device_uri);

}  // namespace dubsar
