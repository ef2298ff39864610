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

/// Turns the faces of a mesh that is inside out over, and gives what to say of it: which face has which
/// number, and which vertex, stays as it is.
[[nodiscard]] std::optional<Error> turned_outwards(Mesh* mesh, const std::string& where);

/// The same, said in the log.
void face_outwards(Mesh* mesh, const std::string& where);

}  // namespace dubsar
