// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/mesh.h"

namespace dubsar {

/// What the faces enclose, mm³, as seen from the middle of their corners: negative where they look inwards.
/// Broken faces count for nothing. Of a mesh that is open it depends on what is missing.
[[nodiscard]] double signed_volume_mm3(const Mesh& mesh);

/// Whether the faces look into the body that they enclose. False, too, for a mesh with so large a hole that
/// nothing can be told: a single side may well be hollow.
[[nodiscard]] bool is_inside_out(const Mesh& mesh);

/// Turns every face over, and the normals, where there are any, with them.
void turn_over(Mesh* mesh);

}  // namespace dubsar
