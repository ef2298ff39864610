// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "fuzz/fuzz_support.h"
#include "ui/shell/script.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto steps = dubsar::ui::parse_script(dubsar::fuzz::text_of(data, size), "script")) {
    for (const dubsar::ui::ScriptStep& step : *steps) {
      dubsar::fuzz::require(step.line > 0);
    }
  }
  return 0;
}
