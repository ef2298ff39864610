// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "formats/ply_header.h"

namespace dubsar {

/// Whether a vertex stands once for each place in a texture: along the texture's seams several times.
[[nodiscard]] bool has_texture_places(const PlyElement& vertex);

/// Which property of the vertices holds the marks of a mesh (1 sparse, 2 interpolated, 4 boundary), -1 where
/// none does: VCG's programs write `flags` of their own, of type int, of which nothing follows for the clay.
[[nodiscard]] int marks_property(const PlyElement& vertex);

/// What a PLY file holds and a mesh does not, by name, in the file's order: "vertex quality", "edge",
/// "texture coordinates". Elements that are empty are not named.
[[nodiscard]] std::vector<std::string> passed_over_of_mesh(const PlyHeader& header);

}  // namespace dubsar
