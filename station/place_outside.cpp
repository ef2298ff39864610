// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/place_outside.h"

#include <optional>
#include <string>

#include "acquisition/session_store.h"
#include "formats/bag_check.h"
#include "formats/resolved_place.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// Of a resolved path.
std::optional<fs::path> around(const fs::path& path) {
  for (fs::path at = path; !at.empty(); at = at.parent_path()) {
    if (SessionStore::is_session(at) || is_bag(at)) {
      return at;
    }
    if (at == at.parent_path()) {
      break;
    }
  }
  return std::nullopt;
}

Status refuse_within(const std::optional<fs::path>& folder, const fs::path& output) {
  if (!folder) {
    return {};
  }
  const fs::path resolved = resolved_place(output);
  const std::string own = *folder == resolved ? "results" : resolved.filename().string();
  const std::string beside = (folder->parent_path() / (folder->filename().string() + "-" + own)).string();
  return SessionStore::is_session(*folder)
             ? fail(ErrorKind::kUsage,
                    "a session keeps a checksum of every file in it; nothing else is written there",
                    output.string(), "write it beside the session: " + beside)
             : fail(ErrorKind::kUsage,
                    "a package keeps a checksum of every file in it; nothing else is written there",
                    output.string(), "write it beside the package: " + beside);
}

}  // namespace

std::optional<fs::path> checked_folder_around(const fs::path& path) {
  return around(resolved_place(path));
}

Status check_outside_checked_folders(const fs::path& output) {
  return refuse_within(checked_folder_around(output), output);
}

Status check_outside_packages(const fs::path& output) {
  const std::optional<fs::path> folder = checked_folder_around(output);
  return folder && !SessionStore::is_session(*folder) ? refuse_within(folder, output) : Status();
}

Status check_place_of_package(const fs::path& package) {
  const fs::path resolved = resolved_place(package);
  return refuse_within(SessionStore::is_session(resolved) ? resolved : around(resolved.parent_path()),
                       package);
}

}  // namespace dubsar
