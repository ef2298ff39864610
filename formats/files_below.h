// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// Every file below a folder, in order, links to files among them; links to folders are not gone into, and
/// what a link leads to in vain is no file. Of what `passes_over` takes nothing is listed, nor what is below
/// it. Errors: kStorage where anything cannot be looked at, so that a list is never one with gaps.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_below(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& passes_over = {});

/// Whether what lies in a folder can be told; so it is of a path that leads to nothing or to no folder.
/// Errors: kStorage where it may not be listed or not be entered, or one above it, or where the disk refuses.
[[nodiscard]] Status check_folder_can_be_read(const std::filesystem::path& folder);

}  // namespace dubsar
