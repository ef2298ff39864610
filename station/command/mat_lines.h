// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "station/command/analyze.h"
#include "station/command/mesh_unit.h"

namespace dubsar {

/// Of which vertex of the mesh each line of `--invariants` is; empty: of each, in their order. Where reading
/// has made several vertices of a PLY one, the lines are of the file's vertices: whoever loads the .mat loads
/// that file. Of an STL or GLB they are of the measured mesh, and a warning says so.
[[nodiscard]] std::vector<std::uint32_t> lines_of_mat(const AnalyzeArguments& arguments,
                                                      const MeshInItsUnit& read);

}  // namespace dubsar
