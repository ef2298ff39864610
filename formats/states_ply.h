// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/range_grid.h"
#include "core/result.h"
#include "core/sample_states.h"

namespace dubsar {

/// One scan's samples with their states as a coloured point cloud (docs/formats/sample_states.md): binary
/// little-endian PLY, model frame, millimetres. Cells without a sample of the tablet are left out.
[[nodiscard]] std::string encode_states_ply(int scan_id, const RangeGrid& grid,
                                            const RigidTransform& model_from_scanner,
                                            const SampleStates& states);
[[nodiscard]] Status write_states_ply(const std::filesystem::path& path, int scan_id, const RangeGrid& grid,
                                      const RigidTransform& model_from_scanner, const SampleStates& states);

/// Whether a file that begins so is one of these.
[[nodiscard]] bool is_states_ply(std::string_view head);

}  // namespace dubsar
