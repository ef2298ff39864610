// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// What lies in a folder of scans, not recursed; hidden files are not looked at.
struct ScanFolder {
  std::vector<std::filesystem::path> scans;       ///< in name order, those that cannot be read too
  std::vector<std::filesystem::path> few_points;  ///< in name order: FileKind::kFewPoints
  std::vector<std::filesystem::path> subfolders;
  std::size_t other_files = 0;  ///< evidently no scans
  bool tables = false;          ///< some of them are .csv
  bool packed = false;          ///< some of them are .gz, .zip or the like

  /// Names what few_points passes over and why, in one line; empty: nothing.
  [[nodiscard]] std::string passed_over() const;
};

/// Errors: kBadInput when the folder cannot be read.
[[nodiscard]] Result<ScanFolder> look_into_folder(const std::filesystem::path& folder);

}  // namespace dubsar
