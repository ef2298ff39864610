// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// Turntable and tilt, or the arm's pose, of each scan, as a session keeps them (document "drives"), so that
/// planning can be gone on with.
[[nodiscard]] std::string drives_to_json(const std::map<int, Placement>& drives);
[[nodiscard]] Result<std::map<int, Placement>> parse_drives(std::string_view text, const std::string& where);

}  // namespace dubsar
