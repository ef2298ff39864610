// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/grid_reader.h"

namespace dubsar {

/// PTX: per scan two counts (columns, then points of a column), the scanner's position and axes, a 4 × 4
/// matrix, then a line per sample, column by column: "x y z", "x y z intensity", "x y z r g b" or
/// "x y z intensity r g b", all of a scan alike; 0 0 0 is no return, and may leave out what follows. A column
/// is a profile: it becomes a row of the grid. Grids stay in the scanner's own frame with the viewer at the
/// origin; the matrix is not applied. Several scans are named "file#0", "file#1", …; one of 0 × 0 samples is
/// passed over with a remark. Decimal commas are read where no number has a point.
[[nodiscard]] Result<std::vector<ScanData>> read_ptx(std::string_view bytes, const std::string& name,
                                                     const GridReadOptions& options);
/// Walks over the headers without keeping a sample.
[[nodiscard]] Result<int> count_ptx_scans(std::string_view bytes, const std::string& name);

/// Point text: "x y z" and, where the first line has them, an intensity (4 or 7 columns), colours 0 to 255 or
/// normals (6 columns), or an intensity and colours (7). Blanks, tabs, commas or semicolons between, or
/// decimal commas (CommaReading); lines that begin with # or //, and lines before the first numbers, are
/// passed over, as is a lone count.
[[nodiscard]] Result<ScanData> read_point_text(std::string_view bytes, const std::string& name,
                                               const GridReadOptions& options);
/// How many lines of three numbers or more stand there.
[[nodiscard]] std::size_t count_point_lines(std::string_view head);

}  // namespace dubsar
