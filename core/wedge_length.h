// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "core/wedge.h"

namespace dubsar {

/// Whether the length of inner edge k is a guess: the mesh ends before the edge does, and the exit that the
/// length is measured to is the one at the surface, in the air. With ExitDefinition::kExtent it is where the
/// edge was seen last, whatever the mesh does behind that.
[[nodiscard]] inline bool length_is_guess(const Wedge& wedge, std::size_t k) {
  return wedge.beyond_mesh[k] && wedge.exit_points_mm[k] == wedge.exit_points_surface_mm[k];
}

}  // namespace dubsar
