// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/json_node.h"

namespace dubsar {

/// A TOML file (1.0) as a document, so that it is read and complained about as a JSON one is. Dates become text.
/// Errors (kBadInput) name the line.
[[nodiscard]] Result<JsonDocument> parse_toml(std::string_view text, const std::string& where);

}  // namespace dubsar
