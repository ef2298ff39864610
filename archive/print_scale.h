// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "archive/html.h"

namespace dubsar {

/// How the sentence begins by which the report tells the size of the six sides on paper.
inline constexpr std::string_view kPrintedWords = "Printed at 100 % they are ";

/// scale: 1 is life size. One sentence, whose only full stop is at its end.
[[nodiscard]] inline std::string printed_words(double scale) {
  return std::string(kPrintedWords) +
         (scale >= 1.0 ? std::string("life size.") : fixed(100 * scale, 0) + " % of life size.");
}

}  // namespace dubsar
