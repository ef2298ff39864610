// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/make_folder.h"

#include <ranges>
#include <system_error>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/refusal.h"

namespace dubsar {

namespace fs = std::filesystem;

Status make_folder(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> made;
  for (fs::path up = folder; up.has_relative_path() && !fs::exists(up, error); up = up.parent_path()) {
    made.push_back(up);
  }
  fs::create_directories(folder, error);
  if (error) {
    return refused(folder, "cannot make the folder", error.value(), "choose a folder that can be written to");
  }
  for (const fs::path& one : std::views::reverse(made)) {
    if (Status synced = sync_folder(folder_of(one)); !synced) {
      return synced;
    }
  }
  return {};
}

}  // namespace dubsar
