// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_drives.h"

#include <string>

#include "station/drives.h"

namespace dubsar {

Result<std::map<int, Placement>> session_drives(const SessionStore& store) {
  const auto text = store.load_document("drives");
  if (!text || !*text) {
    return std::map<int, Placement>();
  }
  return parse_drives(**text, (store.folder() / "session.sqlite").string() + " (drives)");
}

}  // namespace dubsar
