// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/statement_words.h"

#include <imgui.h>

namespace dubsar::ui {

namespace {

constexpr float kSmallestHeadline = 0.6F;  ///< of the large letters: about the normal ones
constexpr float kStep = 0.05F;
constexpr float kFewestPx = 9;  ///< letters below it cannot be read at all

}  // namespace

StatementWords set_words(const Statement& statement, const Fonts& fonts, float width_px, float wanted_px,
                         float most_px) {
  const auto high_px = [&](const ImFont* font, float letters_px, const std::string& text) {
    return text.empty() ? 0.0F : font->CalcTextSizeA(letters_px, 1e6F, width_px, text.c_str()).y;
  };
  const auto set = [&](float headline_px, float detail_px) {
    StatementWords out{headline_px, detail_px, 0, 0};
    out.detail_at_px = high_px(fonts.large, headline_px, statement.headline) + 0.25F * detail_px;
    out.high_px = out.detail_at_px + high_px(fonts.normal, detail_px, statement.detail);
    return out;
  };
  const float large_px = fonts.large->FontSize;
  for (float part = 1; part > kSmallestHeadline; part -= kStep) {
    for (const float detail_px : {fonts.normal->FontSize, fonts.small->FontSize}) {
      const StatementWords words = set(part * large_px, detail_px);
      const bool two_lines =
          high_px(fonts.large, part * large_px, statement.headline) < 2.1F * part * large_px;
      if (words.high_px <= wanted_px && two_lines) {
        return words;
      }
    }
  }
  StatementWords words = set(kSmallestHeadline * large_px, fonts.small->FontSize);
  while (words.high_px > most_px && words.detail_px > kFewestPx) {
    words = set((1 - kStep) * words.headline_px, (1 - kStep) * words.detail_px);
  }
  return words;
}

}  // namespace dubsar::ui
