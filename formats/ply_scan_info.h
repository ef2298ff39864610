// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/range_grid.h"
#include "core/result.h"
#include "formats/ply_header.h"

namespace dubsar {

/// The obj_info lines by which a range-grid PLY of Dubsar's own keeps what made it; lengths in millimetres.
namespace ply_info {
inline constexpr const char* kUnit = "unit";
inline constexpr const char* kRows = "num_rows";
inline constexpr const char* kCols = "num_cols";
inline constexpr const char* kSpacing = "dubsar_spacing_mm";
inline constexpr const char* kDirection = "dubsar_direction";
inline constexpr const char* kLaser = "dubsar_laser_mm";
inline constexpr const char* kCamera = "dubsar_camera_mm";
inline constexpr const char* kMotion = "dubsar_motion_per_row_mm";
inline constexpr const char* kPinTip = "dubsar_pin_tip_diameter_mm";
inline constexpr const char* kTimestamp = "dubsar_timestamp_ns";
inline constexpr const char* kDevice = "dubsar_device";
inline constexpr const char* kSource = "dubsar_source";
}  // namespace ply_info

/// Takes the dubsar_ lines of a header over into the grid; what is absent stays as it is.
[[nodiscard]] Status apply_scan_info(const PlyHeader& header, const std::string& where, RangeGrid& grid);

/// The lines "obj_info …" for a grid, each with its line end; numbers print so that they read back the same.
/// The original name is among them where it is asked for.
[[nodiscard]] std::string scan_info_lines(const RangeGrid& grid, bool with_source);

}  // namespace dubsar
