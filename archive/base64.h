// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace dubsar {

/// Base64 with padding (RFC 4648, section 4), for data URIs.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// The bytes of such a text; nothing when it is none.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace dubsar
