// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "ui/operator/statement.h"
#include "ui/shell/theme.h"

namespace dubsar::ui {

/// How the words of a statement are set: whole, whatever the letters' size.
struct StatementWords {
  float headline_px = 0;   ///< height of its letters
  float detail_px = 0;     ///< likewise
  float detail_at_px = 0;  ///< below the headline's top
  float high_px = 0;       ///< all of it
};

/// In lines of `width_px`. As large as `wanted_px` takes; words that are too many for it in the smaller
/// letters take as much as they need, and beyond `most_px` smaller letters yet.
[[nodiscard]] StatementWords set_words(const Statement& statement, const Fonts& fonts, float width_px,
                                       float wanted_px, float most_px);

}  // namespace dubsar::ui
