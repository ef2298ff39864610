// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "ui/shell/text_table.h"

namespace dubsar::ui {

[[nodiscard]] std::string capitalised(std::string text);
/// What the engine says in English, as a sentence in that language.
[[nodiscard]] std::string sentence(const std::string& english, Language language);
void add_sentence(std::string& to, const std::string& sentence);

}  // namespace dubsar::ui
