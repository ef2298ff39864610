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

}  // namespace dubsar
