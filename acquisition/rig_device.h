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

/// The latest line of the log beside the calibration that a rig's file names, if it is of that calibration
/// and was passed: what the checklist shows. Nothing where there is none, or the files cannot be read.
[[nodiscard]] std::optional<CalibrationCheck> last_verification(const std::filesystem::path& rig_file);

}  // namespace dubsar
