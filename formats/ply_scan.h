// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/grid_reader.h"
#include "formats/ply_header.h"

namespace dubsar {

/// Reads one scan from PLY: a range grid (`range_grid` lists of no or one vertex index, row by row; or as
/// many vertices as num_rows × num_cols, of which NaN, 0 0 0 and `valid` = 0 are no return), else a point
/// cloud. Optional vertex properties: intensity, confidence, red green blue, nx ny nz. The obj_info lines
/// that write_grid_ply() writes are taken over.
[[nodiscard]] Result<ScanData> read_ply_scan(std::string_view bytes, const std::string& name,
                                             const GridReadOptions& options);

/// True when the header is that of a scan and not of a mesh.
[[nodiscard]] bool is_scan_header(const PlyHeader& header);

/// What the file says its numbers are (obj_info unit); an unknown word is an error, none is millimetres.
[[nodiscard]] Result<double> mm_per_unit_of(const PlyHeader& header, const std::string& name);

}  // namespace dubsar
