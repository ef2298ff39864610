// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// As read_mesh(), and a PLY of vertices alone gives a mesh without faces: for who only looks at it.
[[nodiscard]] Result<Mesh> read_mesh_or_points(const std::filesystem::path& path);

}  // namespace dubsar
