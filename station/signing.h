// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/checklist.h"
#include "core/job.h"
#include "core/result.h"
#include "core/sign_off.h"

namespace dubsar {

/// What came of asking for a signature.
struct Signing {
  std::optional<SignOff> made;    ///< nothing when it was refused
  std::optional<Error> refused;   ///< the session is not what may be signed, and what would mend it
  std::optional<Error> no_pages;  ///< signed, but the pages that show it could not be made
  std::filesystem::path page;     ///< the checklist page that shows it; empty without one
  Checklist checklist;            ///< worked out anew, also where it was refused
};

/// Puts a name under the verdict of a session once it has been worked out anew from grids and poses. name,
/// role, note and incomplete of `wanted` are the operator's; the rest is filled in here. It is refused when
/// the stored verdict is not what the scans give, when the poses do not follow what was said of the scans,
/// and, without `incomplete`, when it falls short. Errors: kUsage when there is no session, or nothing that
/// an `incomplete` could mean; kCancelled, the store's.
[[nodiscard]] Result<Signing> sign_verdict(const std::filesystem::path& session, SignOff wanted,
                                           JobContext& job);

}  // namespace dubsar
