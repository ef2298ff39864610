// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>

#include "acquisition/session_store.h"
#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// Where the rig stood for each scan that it was driven to, by id; empty where nothing was. Errors:
/// kBadInput.
[[nodiscard]] Result<std::map<int, Placement>> session_drives(const SessionStore& store);

}  // namespace dubsar
