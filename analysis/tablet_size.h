// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string_view>

#include "core/mesh.h"

namespace dubsar {

/// The diagonal of the box around the vertices that faces use, mm. 0 without any.
[[nodiscard]] double size_across_mm(const Mesh& mesh);

/// A thing `across_mm` large when its numbers were read as `mm_per_number` each: the unit ("m", "mm", "um")
/// that would make an inscribed thing of it, 6 to 800 mm across, when this one does not. Nothing when it
/// does, or when none would.
[[nodiscard]] std::optional<std::string_view> likelier_unit(double across_mm, double mm_per_number);

}  // namespace dubsar
