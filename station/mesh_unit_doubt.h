// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

// What the size of a mesh tells of a unit that nobody said (docs/scholars/measurements.md, "a wrong unit").

struct UnitBySize {
  std::string taken_for;  ///< one of kLengthUnits; empty: what the numbers were read as
  Error doubt;            ///< what there is to say where it is not empty
};

/// How a mesh is measured whose box has these sides in the file's `numbers`, when they were read as
/// `mm_per_number` each. `in_header`: the file states its unit (states_unit()). Errors: kBadInput where
/// nobody can tell: with the units to choose from and the size that each would give.
[[nodiscard]] Result<UnitBySize> unit_by_size(const Eigen::Vector3d& numbers, double mm_per_number,
                                              bool in_header, const std::string& where);

/// The same of a mesh that was read as its file says.
[[nodiscard]] Result<UnitBySize> unit_by_size(const Mesh& as_read, const std::filesystem::path& file);

/// What somebody has to know who measures on a mesh that was read as its file says: that its size makes the
/// unit doubtful. Nothing of 2 to 6 mm where the file says its unit (a GLB is in metres): a part may be as
/// small. `where`: the mesh, for the line.
[[nodiscard]] std::optional<Error> unit_doubt(const Mesh& as_read, const std::filesystem::path& file,
                                              const std::string& where);

/// The same doubt of a mesh whose numbers were taken for `unit` because of it.
[[nodiscard]] Error unit_taken(const std::string& unit, const Error& doubt);

}  // namespace dubsar
