// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_links.h"

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
  const auto check = [&](const char* name) -> Status {
    if (const auto link = link_on_the_way(session, name)) {
      return fail(link->kind, link->what, (session / link->where).string(), link->mend);
    }
    return {};
  };
  for (const char* name : kFolders) {
    if (Status plain = check(name); !plain) {
      return plain;
    }
  }
  for (const char* name : {kDatabase, kBackup, kSums, kLock}) {
    if (Status plain = check(name); !plain) {
      return plain;
    }
  }
  return {};
}

}  // namespace dubsar::session
