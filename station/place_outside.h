// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>

#include "core/result.h"

namespace dubsar {

/// The session or package that a path lies in or is: every byte of it has its checksum, and whatever else is
/// laid there makes it fail its verification. Links are followed.
[[nodiscard]] std::optional<std::filesystem::path> checked_folder_around(const std::filesystem::path& path);

/// kUsage, with a better place, for a file or folder that would lie in a session or package or be one.
[[nodiscard]] Status check_outside_checked_folders(const std::filesystem::path& output);
/// The same for a package alone: what a viewer keeps of a session's mesh is the session's.
[[nodiscard]] Status check_outside_packages(const std::filesystem::path& output);
/// The same for a new package, which may take the place of an earlier one.
[[nodiscard]] Status check_place_of_package(const std::filesystem::path& package);

}  // namespace dubsar
