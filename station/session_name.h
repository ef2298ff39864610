// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

namespace dubsar {

/// The folder by its own name, however it was pointed at: absolute, no "." in it and no slash at its end.
/// Links are not followed: a session goes by the name that it was opened by.
[[nodiscard]] std::filesystem::path whole_name(const std::filesystem::path& folder);

/// What people call a session: its folder's name, as UTF-8.
[[nodiscard]] std::string session_name(const std::filesystem::path& folder);

}  // namespace dubsar
