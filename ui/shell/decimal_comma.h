// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <locale>
#include <string>

#include "ui/shell/text_table.h"

namespace dubsar::ui {

/// Numbers with a decimal comma and nothing between thousands.
[[nodiscard]] const std::locale& with_comma();

/// A number with so many decimals, with a comma where the language has one.
[[nodiscard]] std::string decimal(double value, int decimals, Language language);

/// A written number ("0.25") likewise.
[[nodiscard]] std::string decimal(std::string number, Language language);

/// Decimal commas in what a sentence measures: numbers with a unit, and places of several numbers, which
/// semicolons then part. Left are names, paths, versions and what is to be typed as it stands.
[[nodiscard]] std::string with_decimal_commas(const std::string& sentence);

}  // namespace dubsar::ui
