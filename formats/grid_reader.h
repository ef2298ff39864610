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

#include "core/job.h"
#include "core/point_cloud.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

struct GridReadOptions {
  /// What the file's numbers are; unset: the file's own word (obj_info unit), else millimetres.
  std::optional<double> mm_per_unit{};
  /// Told, with its name, of a scan that was read otherwise than its file says, or that is doubtful.
  std::function<void(const std::string& scan, const std::string& remark)> remark{};
  /// Stops the reading soon after it was cancelled (kCancelled): it is asked between blocks of the file.
  const JobContext* job = nullptr;
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

/// Whether the name is one of an archive or a packed file (.gz, .zip and so on).
[[nodiscard]] bool has_packed_name(const std::filesystem::path& name);

/// What a file in a folder of scans is taken for.
enum class FileKind {
  kScan,       ///< a scan, also one that is damaged or cannot be read: leaving it out would hide that
  kOther,      ///< evidently none: another ending, .conf, a mesh, prose in a .txt
  kFewPoints,  ///< text with numbers, but too few for a scan: a pose, a calibration
  kDoubtful,   ///< a .txt that is empty or cannot be read: a scan where other .txt are such
};

/// Point text with fewer lines of points is no scan when nobody names it.
inline constexpr std::size_t kLeastPointLines = 100;

/// Loads no more than the header, or the first lines. Folders and what is no file are kOther.
[[nodiscard]] FileKind kind_of_file(const std::filesystem::path& path);
/// The same from the beginning of a file; `whole` when it holds no more.
[[nodiscard]] FileKind kind_of_head(std::string_view head, bool whole, const std::filesystem::path& name);

/// True when the file is of kScan.
[[nodiscard]] bool looks_like_scan(const std::filesystem::path& path);

/// How many scans the file holds, those of no samples aside, without keeping any sample. 1 but for PTX.
[[nodiscard]] Result<int> count_scans(const std::filesystem::path& path);

}  // namespace dubsar
