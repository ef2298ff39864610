// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

#include "core/range_grid.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

struct GridPlyOptions {
  bool ascii = false;  ///< else binary little endian
  /// The scan's original name, for a file of another name; else it is not written.
  bool keep_source = false;
  FileLabel label{};  ///< of the tablet, as comments
};

/// A range-grid PLY in millimetres: obj_info lines (see ply_scan_info.h), the valid samples as vertices with
/// intensity and confidence (float) and red green blue (uchar) where the grid has them, then range_grid lists
/// of no or one index, row by row. read_scan_file() gives the same grid back to the bit, but for `nominal`
/// and, unless it is kept, `source`.
[[nodiscard]] std::string encode_grid_ply(const RangeGrid& grid, const GridPlyOptions& options = {});
[[nodiscard]] Status write_grid_ply(const std::filesystem::path& path, const RangeGrid& grid,
                                    const GridPlyOptions& options = {});

}  // namespace dubsar
