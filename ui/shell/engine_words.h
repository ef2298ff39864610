// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

namespace dubsar::ui {

/// A part of a sentence of the engine.
struct EnginePhrase {
  const char* english;
  const char* german;
};

/// What is said of a job that runs; replaced where it is all that is said.
[[nodiscard]] std::span<const EnginePhrase> engine_stages();

/// What readers remark on the files of others; replaced after the rest.
[[nodiscard]] std::span<const EnginePhrase> engine_remarks();

/// All others that are known, in the order in which they are replaced (text_table.h: translated()).
[[nodiscard]] std::span<const EnginePhrase> engine_phrases();

}  // namespace dubsar::ui
