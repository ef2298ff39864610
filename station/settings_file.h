// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string_view>

#include "core/result.h"

namespace dubsar {

/// Replaces what a face keeps for its next start, in a folder that is made where there is none yet: by the
/// whole text, also after a power loss, or not at all. A link to a file stays one. Errors: kStorage, kUsage
/// where a folder lies there.
[[nodiscard]] Status write_settings_file(const std::filesystem::path& file, std::string_view text);

}  // namespace dubsar
