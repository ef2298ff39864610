// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/json_node.h"

namespace dubsar {

/// JSON objects that a person's work is kept in outside of any list of checksums carry their own: the last
/// member, "xxh128", is XXH3 (128 bits, canonical, 32 hexadecimal digits) of all bytes before its comma.
inline constexpr const char* kOwnChecksum = "xxh128";

/// `json` is one object with at least one member, with or without a line's end.
[[nodiscard]] std::string with_own_checksum(std::string json);

enum class OwnChecksum {
  kNone,  ///< the text does not end with one, nor with what is left of one
  kFits,
  kFails,  ///< also when it is the checksum that was damaged
};
[[nodiscard]] OwnChecksum own_checksum_of(std::string_view text);

/// The document of such a text; kBadInput where its checksum fails, or it is no JSON. Its members are to be
/// read with kOwnChecksum among those that may be there.
[[nodiscard]] Result<JsonDocument> parse_self_checked(std::string_view text, const std::string& where);

}  // namespace dubsar
