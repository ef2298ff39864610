// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_links.h"

#include <iterator>
#include <vector>

#include "acquisition/session_files.h"

namespace dubsar::session {

namespace fs = std::filesystem;

std::optional<Error> link_on_the_way(const fs::path& session, const fs::path& name) {
  fs::path part;
  for (const fs::path& one : name) {
    part /= one;
    std::error_code ignored;
    if (fs::is_symlink(session / part, ignored)) {
      return Error{ErrorKind::kBadInput, "a link, which is not followed", part.generic_string(),
                   "put what it leads to in its place"};
    }
  }
  return std::nullopt;
}

Status check_written_names_are_no_links(const fs::path& session) {
  std::vector<const char*> written(std::begin(kFolders), std::end(kFolders));
  written.insert(written.end(), {kDatabase, kBackup, kSums});  // the lock looks for itself
  for (const char* name : written) {
    if (const auto link = link_on_the_way(session, name)) {
      return fail(link->kind, link->what, (session / link->where).string(), link->mend);
    }
  }
  return {};
}

}  // namespace dubsar::session
