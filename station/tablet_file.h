// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"
#include "formats/mesh_io.h"
#include "sim/scanner.h"
#include "sim/tablet.h"

namespace dubsar {

/// A simulated tablet's surface as a mesh file; the albedo travels as grey vertex colour.
[[nodiscard]] Status write_tablet_file(const std::filesystem::path& path, const sim::SimTablet& tablet);

/// Any mesh as something to scan: albedo from its colours, else that of plain clay. Centred on the origin it
/// is not: the mesh's own frame stays. Errors: bad input, a mesh without faces.
[[nodiscard]] Result<sim::SimTablet> read_tablet_file(const std::filesystem::path& path,
                                                      const MeshReadOptions& options = {});

/// The scanner with a field and depth range that take in the whole tablet from every side.
[[nodiscard]] sim::ScannerOptions fitted_to(sim::ScannerOptions scanner, const sim::SimTablet& tablet);

}  // namespace dubsar
