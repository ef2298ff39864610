// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// Where a path leads, whether it is there yet or not: absolute, links followed before ".." goes up from
/// where they lead, no slash at the end.
[[nodiscard]] std::filesystem::path resolved_place(const std::filesystem::path& path);

/// Whether each ".." of a path goes up from a folder that is there, as the system asks; resolved_place()
/// takes one that is not there by its name. Errors: kUsage.
[[nodiscard]] Status check_goes_up_from_folders(const std::filesystem::path& path);

}  // namespace dubsar
