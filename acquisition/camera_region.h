// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/rig_calibration.h"
#include "drivers/device.h"
#include "formats/rig_toml.h"

namespace dubsar {

/// The same rig with a camera that sends a part of its picture: rays, laser plane and scanner frame stay what
/// they are. Errors (kBadInput): a region beyond the picture that was calibrated, or without the middle of
/// the measuring volume.
[[nodiscard]] Result<RigCalibration> seen_in(const PictureRegion& region, const RigCalibration& calibration,
                                             const std::string& where);

/// What the camera's picture holds to either side of the middle of the measuring volume, mm: along the
/// profile, and in depth, where it is no more than the volume has.
[[nodiscard]] double field_mm(const RigCalibration& calibration, bool stripe_per_row);
[[nodiscard]] double depth_mm(const RigCalibration& calibration);

/// Asks the camera for it. kUsage: it sends no part of its picture, or not this one.
Status put_region(const PictureRegion& region, Device& camera, const std::string& where);
/// Asks it for all it has, as it is calibrated: scans with a part may have been before. Errors as
/// put_region().
Status put_whole_picture(Device& camera, const std::string& where);

}  // namespace dubsar
