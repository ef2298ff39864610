// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// The sides of the box around the vertices that faces use, mm. 0 without any.
[[nodiscard]] Eigen::Vector3d size_mm(const Mesh& mesh);

/// Its diagonal.
[[nodiscard]] double size_across_mm(const Mesh& mesh);

/// A thing `across_mm` large when its numbers were read as `mm_per_number` each: the units ("mm", "m",
/// "um", then "cm" and "in") that would make an inscribed thing of it, 6 to 800 mm
/// across, when this one does not. None when it does, or when none would.
[[nodiscard]] std::vector<std::string_view> likelier_units(double across_mm, double mm_per_number);

/// Whether an inscribed thing may be so large, 6 to 800 mm across.
[[nodiscard]] bool is_inscribed_size(double across_mm);

/// Of likelier_units() the one among "m", "mm" and "um": these are what files are in whose makers said
/// nothing, and a thousand apart, so that no two make an inscribed thing of the same numbers.
[[nodiscard]] std::optional<std::string_view> likely_unit(double across_mm, double mm_per_number);

/// How far apart the places are, at the vertex in use that lies farthest from the origin, between which
/// single precision knows none, mm.
[[nodiscard]] double coarsest_place_mm(const Mesh& mesh);

/// Why nothing can be measured of a mesh, whatever its unit: a kilometre across and more, or so far from the
/// origin of its numbers that single precision decides what is measured. `where`: the mesh, for the error.
[[nodiscard]] Status check_measurable(const Mesh& mesh, const std::string& where);

}  // namespace dubsar
