// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// One line of UTF-8 as it is seen from left to right (UAX #9), for what draws one code point beside the next
/// as a window does: Arabic letters are their joined forms (Unicode's Arabic Presentation Forms), brackets of
/// text to the left are mirrored. A line without Arabic or Hebrew comes back byte for byte. What is broken
/// into lines must be broken before.
[[nodiscard]] std::string seen_line(std::string_view line);

}  // namespace dubsar
