// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// That there is a session, whole or damaged (SessionStore::is_session()), or why there is none. Errors:
/// kUsage; kStorage where the folder cannot be read, so that nobody can tell.
[[nodiscard]] Status check_is_session(const std::filesystem::path& folder);

}  // namespace dubsar
