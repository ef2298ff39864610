// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>

#include "core/result.h"

/// Links in a session: what is stored lies in the session itself. A link leads to bytes that belong to
/// somebody else, or that do not come along when the session is copied.
namespace dubsar::session {

/// The fault of the first part of `name` (relative, below the session) that is a link; nothing when none is.
[[nodiscard]] std::optional<Error> link_on_the_way(const std::filesystem::path& session,
                                                   const std::filesystem::path& name);

/// SQLite writes its tables in place: in a copy of the session by hard links (cp -al) it would write those of
/// the original. Gives the tables, and the log beside them, a file of their own where they have other names.
/// Under the lock. Errors: kStorage, kBadInput where they cannot be read.
[[nodiscard]] Status take_tables_apart(const std::filesystem::path& session);

/// Nothing is written into a session whose folders, tables or list of checksums are links.
[[nodiscard]] Status check_written_names_are_no_links(const std::filesystem::path& session);

}  // namespace dubsar::session
