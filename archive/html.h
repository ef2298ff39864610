// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// Outside text with U+FFFD for control characters (but tabs and the ends of lines, which are line feeds
/// then), for bytes that are not UTF-8, for what is no character, and for marks that turn the direction of
/// writing.
[[nodiscard]] std::string cleaned(std::string_view text);

/// cleaned(), and made safe for HTML, as content or inside a quoted attribute: the five special characters
/// become entities.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// "3.14" with a fixed number of decimals; an en dash for what is not a number.
[[nodiscard]] std::string fixed(double value, int decimals);

/// "1 scan", "2 scans".
[[nodiscard]] std::string counted(long long count, std::string_view one, std::string_view many);

}  // namespace dubsar
