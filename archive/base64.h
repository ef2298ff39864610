// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dubsar {

/// Base64 with padding (RFC 4648, section 4), for data URIs.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace dubsar
