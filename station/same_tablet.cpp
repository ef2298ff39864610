// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/same_tablet.h"

#include <optional>
#include <string>
#include <string_view>

#include "acquisition/session_store.h"
#include "formats/file_label_reader.h"
#include "formats/resolved_place.h"
#include "station/tablet_label.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kResults = ".results";

/// The session that a path lies in, or among whose results.
std::optional<fs::path> session_of(const fs::path& path) {
  const fs::path resolved = resolved_place(path);
  for (fs::path at = resolved.parent_path(); at != at.parent_path(); at = at.parent_path()) {
    if (SessionStore::is_session(at)) {
      return at;
    }
    const std::string name = at.filename().string();
    const fs::path beside =
        name.ends_with(kResults) ? at.parent_path() / name.substr(0, name.size() - kResults.size()) : at;
    if (beside != at && SessionStore::is_session(beside)) {
      return beside;
    }
  }
  return std::nullopt;
}

}  // namespace

bool is_of_the_tablet_of(const fs::path& mesh, const fs::path& corrections) {
  const std::optional<fs::path> session = session_of(corrections);
  if (!session) {
    return false;
  }
  if (session_of(mesh) == session) {
    return true;
  }
  const std::string name = read_mesh_label(mesh).name;
  if (name.empty()) {
    return false;
  }
  const Result<SessionStore> store = SessionStore::open(*session, SessionStore::Access::kReadOnly);
  const Result<FileLabel> label =
      store ? tablet_label(*store) : Result<FileLabel>(std::unexpected(store.error()));
  return label && label->name == name;
}

}  // namespace dubsar
