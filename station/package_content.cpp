// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package_content.h"

#include "formats/atomic_file.h"

namespace dubsar {

namespace fs = std::filesystem;

Result<fs::path> PackageContent::place(const std::string& path) const {
  const fs::path whole = root / path;
  std::error_code error;
  fs::create_directories(whole.parent_path(), error);
  if (error) {
    return fail(ErrorKind::kStorage, error.message(), whole.parent_path().string(),
                "free some space or choose another folder");
  }
  return whole;
}

Status PackageContent::text(const std::string& path, std::string_view content, std::string what) {
  const Result<fs::path> whole = place(path);
  if (!whole) {
    return std::unexpected(whole.error());
  }
  if (const Status written = write_file_atomically(*whole, content); !written) {
    return written;
  }
  list(path, std::move(what));
  return {};
}

Status PackageContent::need_fields() {
  if (fields) {
    return {};
  }
  Result<PackageFields> made = package_fields(mesh(), job);
  if (!made) {
    return std::unexpected(made.error());
  }
  fields = std::move(*made);
  return {};
}

}  // namespace dubsar
