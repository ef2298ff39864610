// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// Where a path leads, whether it is there yet or not: absolute, links followed, no slash at the end.
[[nodiscard]] std::filesystem::path resolved_place(const std::filesystem::path& path);

/// kUsage, with a better place, for a file or folder that would lie in a session or be one: every byte of a
/// session has its checksum, and a result beside them would look like something foreign. Links are followed.
[[nodiscard]] Status check_outside_sessions(const std::filesystem::path& output);

}  // namespace dubsar
