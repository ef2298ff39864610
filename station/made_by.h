// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "acquisition/session_store.h"
#include "core/result.h"

namespace dubsar {

/// Which programs made what a session keeps, such as "Dubsar 0.1.0"; empty where that is not known.
struct MadeBy {
  std::string scanned;  ///< the last run that came to a verdict (document "run")
  std::string placed;   ///< the scans, last
  std::string judged;   ///< them, last: red map and checklist
};

[[nodiscard]] MadeBy made_by(const SessionStore& store);

/// After this program worked places or verdict out anew: noted (document "programs") where the session would
/// tell of another one. A session whose first run is not over yet has nothing to tell. Errors: the store's.
[[nodiscard]] Status note_placed(SessionStore& store);
[[nodiscard]] Status note_judged(SessionStore& store);

}  // namespace dubsar
