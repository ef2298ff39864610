// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "core/wedge.h"

namespace dubsar {

/// What there is to say where wedges are not of this mesh, whatever the names say: less than three quarters
/// of their depth points lie within a third of a depth of its surface. Of the mesh that they were found on 96
/// % and more do (on meshes as coarse as 0.24 mm), and so they do of a copy, whatever its format; of another
/// tablet of the same size 43 % did; on clay that was never written on they lie a depth away. Nothing where
/// no wedge says its depth. `where`: the file of the wedges.
[[nodiscard]] std::optional<Error> of_another_mesh(const std::vector<Wedge>& wedges, const Mesh& mesh,
                                                   const std::string& where);

}  // namespace dubsar
