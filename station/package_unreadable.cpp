// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Folders of the session that cannot be read: what lay in them may be told nowhere else.

#include <fmt/format.h>

#include "acquisition/session_files.h"
#include "formats/files_below.h"
#include "station/package_content.h"

namespace dubsar {

Status add_unreadable(PackageContent& content) {
  const std::filesystem::path& session = content.store.folder();
  for (const Error& folder : everything_below(session).unreadable) {
    const std::string name = std::filesystem::path(folder.where).lexically_relative(session).generic_string();
    if (!session::in_a_folder_of_the_session(name)) {
      continue;  // somebody else's, which is not packed
    }
    content.lacking.push_back(
        fmt::format("The session's folder {} could not be read when this was packed ({}): what lay in it is "
                    "here only as far as this page says so.",
                    name, folder.what));
  }
  return {};
}

}  // namespace dubsar
