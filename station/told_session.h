// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/result.h"

namespace dubsar {

/// What opening a session found damaged, rebuilt or lost, one line each: what a person has to hear of it,
/// whoever opened it.
[[nodiscard]] std::vector<std::string> told_of_opening(const SessionStore& store);

/// Opens a session as a verb does, and says on standard error what there is to say of it. What is read or
/// worked out of damaged records (register, plan, stitch, scan) goes on with what is left.
[[nodiscard]] Result<SessionStore> open_told(
    const std::filesystem::path& session, SessionStore::Access access,
    SessionStore::OnDamage on_damage = SessionStore::OnDamage::kRebuild);

/// Opens it for a person's word on a scan or on the tablet: lock, drop, hint, describe. Damaged records are
/// refused: such a word adds one line to the record, and opening for it would rebuild all of it of what is
/// left, where `verify --repair --from COPY` may bring back everything. Nobody is kept from scanning on: a
/// scan opens the session in its own way, and damaged grids, or records that were lost before, refuse
/// nothing.
[[nodiscard]] Result<SessionStore> open_for_a_word(const std::filesystem::path& session);

}  // namespace dubsar
