// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "formats/ply_header.h"

namespace dubsar {

/// Whether a vertex stands once for each place in a texture: along the texture's seams several times.
[[nodiscard]] bool has_texture_places(const PlyElement& vertex);

/// What a PLY file holds and a mesh does not, by name, in the file's order: "vertex quality", "edge",
/// "texture coordinates". Elements that are empty are not named.
[[nodiscard]] std::vector<std::string> passed_over_of_mesh(const PlyHeader& header);

}  // namespace dubsar
