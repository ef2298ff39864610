// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/mesh.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// What to do about what lies too far from its origin.
inline constexpr const char* kMoveNear =
    "export it without the offset of a map or a room, or give its unit if that is what is wrong";

/// kBadInput when a grid lies so far from its origin that float coordinates take an eighth of its spacing or
/// more.
[[nodiscard]] Status check_precision(const RangeGrid& grid, const std::string& name);

/// The same for a mesh, whose spacing is the median length of its edges; one without faces, as may be left
/// where all fell together, has none.
[[nodiscard]] Status check_precision(const Mesh& mesh, const std::string& name);

}  // namespace dubsar
