// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <set>
#include <string>

#include "acquisition/session_store.h"

namespace dubsar {

/// What records a session has lost and nothing has brought back, now or before: each kind once, in a
/// person's words ("a signature"). A row that is lost says what table it was of, and hardly more. Empty: none
/// are.
[[nodiscard]] std::set<std::string> lost_records(const SessionStore& store);

/// The same as words of one sentence: "a signature; where scans lie".
[[nodiscard]] std::string one_line(const std::set<std::string>& kinds);

/// Whether records of this scan were lost, so that it stands where it may have been taken out.
[[nodiscard]] bool may_have_been_taken_out(const StoredScan& scan);

/// Why its grid cannot be read, by what opening the session found; empty where it can.
[[nodiscard]] std::string damage_of(const SessionStore& store, const StoredScan& scan);

}  // namespace dubsar
