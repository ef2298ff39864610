// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// A rig as a session keeps it, so that its verdict can be worked out again without the device.
[[nodiscard]] std::string rig_to_json(const Rig& rig);
[[nodiscard]] Result<Rig> parse_rig(std::string_view text, const std::string& where);

}  // namespace dubsar
