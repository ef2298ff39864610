// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_presence.h"

#include "acquisition/session_store.h"
#include "formats/files_below.h"

namespace dubsar {

Status check_is_session(const std::filesystem::path& folder) {
  if (SessionStore::is_session(folder)) {
    return {};
  }
  if (Status readable = check_folder_can_be_read(folder); !readable) {
    return readable;
  }
  return fail(ErrorKind::kUsage, "no session there", folder.string(),
              "name the folder that a scan was stored in");
}

}  // namespace dubsar
