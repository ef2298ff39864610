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

}  // namespace dubsar
