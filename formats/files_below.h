// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// What lies below a folder, as far as it can be told.
struct FoundBelow {
  std::vector<std::filesystem::path> files;  ///< in order
  /// kStorage: folders that cannot be listed or not be entered, and what cannot be looked at; what lies below
  /// them is not among the files.
  std::vector<Error> unreadable;
};
using PassesOver = std::function<bool(const std::filesystem::path&)>;

/// Everything but folders: sockets and pipes too, and links, which are not followed. Of what `passes_over`
/// takes nothing is listed, nor what is below it.
[[nodiscard]] FoundBelow everything_below(const std::filesystem::path& folder,
                                          const PassesOver& passes_over = {});
/// Files, links to files among them; what a link leads to in vain is no file.
[[nodiscard]] FoundBelow readable_files_below(const std::filesystem::path& folder,
                                              const PassesOver& passes_over = {});

/// The files of readable_files_below(). Errors: kStorage where anything cannot be looked at, so that a list
/// is never one with gaps.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_below(const std::filesystem::path& folder,
                                                                     const PassesOver& passes_over = {});

/// Whether what lies in a folder can be told; so it is of a path that leads to nothing or to no folder.
/// Errors: kStorage where it may not be listed or not be entered, or one above it, or where the disk refuses.
[[nodiscard]] Status check_folder_can_be_read(const std::filesystem::path& folder);

}  // namespace dubsar
