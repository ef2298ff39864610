// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package_content.h"

#include "formats/atomic_file.h"
#include "formats/make_folder.h"

namespace dubsar {

namespace fs = std::filesystem;

Result<fs::path> PackageContent::place(const std::string& path) const {
  const fs::path whole = root / path;
  if (const Status made = make_folder(whole.parent_path()); !made) {
    return std::unexpected(made.error());
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
