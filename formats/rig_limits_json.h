// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/motion_limits.h"
#include "core/result.h"

namespace dubsar {

/// A rig file (docs/formats/rig.md): what the operator allows of the rig. A word that is not known is
/// refused: a limit that was misspelt would not hold.
[[nodiscard]] Result<RigLimits> parse_rig_limits(std::string_view text, const std::string& where);
[[nodiscard]] Result<RigLimits> read_rig_limits(const std::filesystem::path& file);
[[nodiscard]] std::string rig_limits_to_json(const RigLimits& limits);

}  // namespace dubsar
