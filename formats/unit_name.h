// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string_view>

namespace dubsar {

/// Millimetres per unit, as people and programs write it in headers: mm_per_unit()'s words and their long
/// names, one or many, British or American, in letters of any size; µm and microns. Nothing for any other.
[[nodiscard]] std::optional<double> mm_per_unit_as_written(std::string_view word);

}  // namespace dubsar
