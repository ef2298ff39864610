// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/resolved_place.h"

#include <system_error>

namespace dubsar {

namespace fs = std::filesystem;

fs::path resolved_place(const fs::path& path) {
  std::error_code error;
  // A name of which nothing exists yet would stay relative, and have no folders above it.
  const fs::path whole = fs::absolute(path, error);
  fs::path resolved = fs::weakly_canonical(whole, error);
  if (error) {
    resolved = whole.lexically_normal();
  }
  return resolved.has_filename() ? resolved : resolved.parent_path();
}

Status check_goes_up_from_folders(const fs::path& path) {
  std::error_code ignored;
  fs::path so_far;
  for (const fs::path& name : path) {
    if (name == ".." && !so_far.empty() && !fs::is_directory(so_far, ignored)) {
      return fail(ErrorKind::kUsage, "there is no folder to go up from", so_far.string(),
                  "write the path without it");
    }
    so_far /= name;
  }
  return {};
}

}  // namespace dubsar
