// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedges_beside.h"

namespace dubsar {

namespace fs = std::filesystem;

bool are_of(const WedgeFile& wedges, const fs::path& mesh) {
  return fs::path(wedges.mesh).filename() == mesh.filename();
}

WedgesPlace wedges_beside(const fs::path& mesh) {
  fs::path own = mesh;
  own.replace_extension(".wedges.json");
  std::error_code error;
  WedgesPlace out{own, false, {}};
  if (fs::is_regular_file(own, error)) {
    return out;
  }
  const fs::path folder = fs::absolute(mesh).lexically_normal().parent_path();
  const fs::path session = folder.parent_path();
  const fs::path of_session = session / "analysis" / "wedges.json";
  for (const fs::path& file : {folder / "wedges.json", of_session}) {
    if (!fs::is_regular_file(file, error)) {
      continue;
    }
    const bool in_session = file == of_session;
    if (in_session && mesh.filename() == "model.ply") {
      return {file, true, out.unread};  // whatever is wrong with it, it is what the session has
    }
    const Result<WedgeFile> known = read_wedges(file);
    if (known && are_of(*known, mesh)) {
      return {file, in_session, out.unread};
    }
    if (!known && !out.unread) {
      out.unread = known.error();
    }
  }
  if (mesh.filename() == "model.ply" && fs::is_regular_file(session / "session.sqlite", error)) {
    out.file = of_session;
    out.in_session = true;
  }
  return out;
}

}  // namespace dubsar
