// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>

#include "station/tablet_record.h"

namespace dubsar {

/// A name for the session of the next tablet, where nothing lies beside this session yet: "box" → "box-2",
/// "box-2" → "box-3".
[[nodiscard]] std::filesystem::path next_session_name(const std::filesystem::path& session);

/// What lies in a folder that is to be the next session.
struct FoundSession {
  TabletRecord record;
  int scans = 0;         ///< that stand
  bool is_read = false;  ///< else nothing of it is known
};

/// Nothing where no session lies there.
[[nodiscard]] std::optional<FoundSession> session_found(const std::filesystem::path& folder);

}  // namespace dubsar
