// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

namespace dubsar {

/// Where a path leads, whether it is there yet or not: absolute, links followed before ".." goes up from
/// where they lead, no slash at the end.
[[nodiscard]] std::filesystem::path resolved_place(const std::filesystem::path& path);

}  // namespace dubsar
