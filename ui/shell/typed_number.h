// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

namespace dubsar::ui {

/// What somebody typed as a number, all of it, with a decimal point or a comma and blanks around it; nothing
/// where it is none, or not finite.
[[nodiscard]] std::optional<double> typed_number(const std::string& text);

/// The same as drivers read it, digit by digit: with a point and without blanks. What is no number stays as
/// it was typed, to be refused by who knows what is wanted.
[[nodiscard]] std::string number_word(const std::string& text);

}  // namespace dubsar::ui
