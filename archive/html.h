// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// Outside text made safe for HTML, as content or inside a quoted attribute: the five special characters
/// become entities; control characters, bytes that are not UTF-8, and marks that turn the direction of
/// writing become U+FFFD.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// "3.14" with a fixed number of decimals; an en dash for what is not a number.
[[nodiscard]] std::string fixed(double value, int decimals);

/// "1 scan", "2 scans".
[[nodiscard]] std::string counted(long long count, std::string_view one, std::string_view many);

}  // namespace dubsar
