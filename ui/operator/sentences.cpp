// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/sentences.h"

#include <fmt/format.h>

#include <cctype>

namespace dubsar::ui {

std::string capitalised(std::string text) {
  if (!text.empty()) {
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  }
  return text;
}

std::string sentence(const std::string& english, Language language) {
  return fmt::format("{}.", capitalised(translated(english, language)));
}

void add_sentence(std::string& to, const std::string& sentence) {
  to += (to.empty() ? "" : " ") + sentence;
}

}  // namespace dubsar::ui
