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

/// Nothing is written into a session whose folders, tables or list of checksums are links.
[[nodiscard]] Status check_written_names_are_no_links(const std::filesystem::path& session);

}  // namespace dubsar::session
