// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dubsar {

/// Writes GigaMesh's text form of per-vertex values: after lines of comment that begin with #, one line a
/// vertex: its index, then its values, parted by blanks. value: [V × per_vertex]; comment: lines without #.
/// Atomic. Six significant digits; what is not finite is written as 0.
[[nodiscard]] Status write_feature_mat(const std::filesystem::path& path, std::span<const float> value,
                                       std::size_t per_vertex, std::string_view comment);

}  // namespace dubsar
