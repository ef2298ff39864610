// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "ui/shell/text_table.h"

namespace dubsar::ui {

struct TextRow {
  Text text;
  const char* english;
  const char* german;
};

/// The row of a text that names red, where what is under-sampled is blue; null for all others.
[[nodiscard]] const TextRow* text_in_blue(Text text);

}  // namespace dubsar::ui
