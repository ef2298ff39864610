// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/sign_off.h"
#include "core/utf8.h"

namespace dubsar {

/// "signed by A. Reader, conservator, 2026-01-02T03:04:05Z: conclusive; it holds", in one line.
[[nodiscard]] inline std::string sign_off_line(const CheckedSignOff& checked) {
  const SignOff& s = checked.sign_off;
  // One that was made elsewhere may say anything.
  std::string line = one_line("signed by " + s.name + (s.role.empty() ? "" : ", " + s.role) + ", " + s.when +
                              ": " + (s.conclusive ? "conclusive" : "not conclusive") +
                              (s.incomplete.empty() ? "" : " (incomplete: " + s.incomplete + ")"));
  if (checked.holds()) {
    return line + "; it holds";
  }
  line += "; VOID: ";
  for (std::size_t k = 0; k < checked.changed.size(); ++k) {
    line += (k == 0 ? "" : ", ") + checked.changed[k];
  }
  return line;
}

}  // namespace dubsar
