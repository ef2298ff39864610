// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// Makes the folder, and those that it lies in, where they are not there yet. Their names survive a power
/// loss after this, where the file system can sync a folder at all. Errors: kStorage.
[[nodiscard]] Status make_folder(const std::filesystem::path& folder);

}  // namespace dubsar
