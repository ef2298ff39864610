// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/red_map.h"
#include "core/result.h"
#include "formats/json_text.h"

namespace dubsar {

/// `plan --json` and the red map of a session (docs/formats/red_map.md).
/// [{"scans":[5,6],"say":"…"}]
[[nodiscard]] OrderedJson apart_json(const std::vector<GroupApart>& groups);
[[nodiscard]] std::string red_map_to_json(const RedMap& map);
[[nodiscard]] Status write_red_map(const std::filesystem::path& path, const RedMap& map);
[[nodiscard]] Result<RedMap> parse_red_map(std::string_view text, const std::string& where);

}  // namespace dubsar
