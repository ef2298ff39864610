// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

namespace dubsar {

/// A name for the session of the next tablet, where nothing lies beside this session yet: "box" → "box-2",
/// "box-2" → "box-3".
[[nodiscard]] std::filesystem::path next_session_name(const std::filesystem::path& session);

}  // namespace dubsar
