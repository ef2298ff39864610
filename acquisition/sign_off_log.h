// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/result.h"
#include "core/sign_off.h"

namespace dubsar {

// Sign-offs are kept in the session's record of what happened, one event each, and with each a copy of the
// red map and the checklist that were signed, under names of their own: nothing is ever overwritten.

/// What a sign-off stands for, as text (docs/formats/sign_off.md): a line per scan that stands with the
/// SHA-256 of its file, a line per pose, one for the red map and one for the verdict. The same session gives
/// the same bytes. Reads every grid. Errors: kCancelled; kBadInput for what is damaged or missing.
[[nodiscard]] Result<std::string> session_manifest(const SessionStore& store, const JobContext& job);

/// Signs the session as it is: fills in number, digest and `conclusive` from the session, and stores the
/// sign-off, durably, with red map and checklist. name, role, note, when, incomplete and program are the
/// caller's; their text is taken as it is. Errors: kUsage without a name, or where `conclusive` is not what
/// the stored red map says; those of the store.
[[nodiscard]] Result<SignOff> sign_session(SessionStore& store, SignOff sign_off, const JobContext& job);

/// All sign-offs, oldest first, each held against the session as it is. What cannot be read is named in
/// `damage`.
struct SignOffLog {
  std::vector<CheckedSignOff> sign_offs;
  std::vector<Error> damage;
};
[[nodiscard]] Result<SignOffLog> read_sign_offs(const SessionStore& store, const JobContext& job);

}  // namespace dubsar
