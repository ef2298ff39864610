// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/place_outside.h"

#include <optional>
#include <string>

#include "acquisition/session_store.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// The session that a path lies in or is.
std::optional<fs::path> session_around(const fs::path& path) {
  for (fs::path at = path; !at.empty(); at = at.parent_path()) {
    if (SessionStore::is_session(at)) {
      return at;
    }
    if (at == at.parent_path()) {
      break;
    }
  }
  return std::nullopt;
}

}  // namespace

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

Status check_outside_sessions(const fs::path& output) {
  const fs::path resolved = resolved_place(output);
  const std::optional<fs::path> session = session_around(resolved);
  if (!session) {
    return {};
  }
  const std::string own = *session == resolved ? "results" : resolved.filename().string();
  const fs::path beside = session->parent_path() / (session->filename().string() + "-" + own);
  return fail(ErrorKind::kUsage,
              "a session keeps a checksum of every file in it; nothing else is written there",
              output.string(), "write it beside the session: " + beside.string());
}

}  // namespace dubsar
