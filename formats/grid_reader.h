// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/point_cloud.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

struct GridReadOptions {
  /// What the file's numbers are; unset: the file's own word (obj_info unit), else millimetres.
  std::optional<double> mm_per_unit{};
  /// Told, with its name, of a scan that was read otherwise than its file says, or that is doubtful.
  std::function<void(const std::string& scan, const std::string& remark)> remark{};
};

using ScanData = std::variant<RangeGrid, PointCloud>;

/// A coordinate beyond this (1 km) is no measurement of a tablet: the cell is invalid, as for NaN.
inline constexpr double kMaxCoordinateMm = 1e6;

/// Reads every scan of a file: range-grid PLY (Stanford style, ASCII or binary of either byte order; or an
/// ordered PLY of num_rows × num_cols vertices), plain point PLY, PTX, point text (.xyz .asc .txt .pts) and
/// Dubsar's own grid. Grids keep the scanner's own frame, millimetres; `source` is the file's name. Errors
/// are one line: file, element or line, and the mend. A `.conf` beside the scans is never read.
[[nodiscard]] Result<std::vector<ScanData>> read_scan_file(const std::filesystem::path& path,
                                                           const GridReadOptions& options = {});

/// The same from bytes; `name` decides the format where the bytes do not, and stands in errors and `source`.
[[nodiscard]] Result<std::vector<ScanData>> read_scan_bytes(std::string_view bytes, const std::string& name,
                                                            const GridReadOptions& options = {});

/// True when the beginning of the file is that of a scan, or of a PLY that cannot be made out; loads no more
/// than the header. Meshes (a PLY with faces), .conf files and unreadable files are not.
[[nodiscard]] bool looks_like_scan(const std::filesystem::path& path);

/// How many scans the file holds, without keeping any sample. 1 but for PTX.
[[nodiscard]] Result<int> count_scans(const std::filesystem::path& path);

}  // namespace dubsar
