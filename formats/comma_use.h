// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dubsar {

/// What the commas in a line of numbers are.
enum class CommaUse {
  kNone,       ///< there are none, or it is no line of numbers
  kDecimal,    ///< they stand for the decimal point
  kSeparator,  ///< they stand between numbers
  kEither,     ///< the line alone does not tell
};

/// Decimal where blanks or semicolons part three words or more, each comma stands alone in its word between
/// digits, no such word has a point, and each of the first three has its comma. Separators where a word has
/// two, or one at its end or beside a sign, where there are too few words for a point without them, and where
/// a number has a point, unless the commas may part thousands.
[[nodiscard]] CommaUse comma_use(std::string_view line);

/// What the commas of a file are, told line by line.
class CommaReading {
 public:
  /// Whether the numbers of this line have decimal commas. A line that does not tell goes by the others:
  /// `rest` is what follows it. kBadInput (line `number` of file `name`) where nothing tells, or where the
  /// lines contradict each other.
  [[nodiscard]] Result<bool> decimal(std::string_view line, std::string_view rest, std::size_t number,
                                     const std::string& name);

 private:
  CommaUse use_ = CommaUse::kNone;
};

}  // namespace dubsar
