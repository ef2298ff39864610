// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// Why a mesh that is inside out is dark in pictures and has no wedges, and the mend; nothing for any other.
[[nodiscard]] std::optional<Error> inside_out(const Mesh& mesh, const std::string& where);

/// Turns the faces of a mesh that is inside out over, and says so in the log: for who measures or draws it
/// once, and keeps nothing that counts its faces.
void face_outwards(Mesh* mesh, const std::string& where);

}  // namespace dubsar
