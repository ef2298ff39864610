// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

namespace dubsar::ui {

/// A part of a sentence of the engine.
struct EnginePhrase {
  const char* english;
  const char* german;
};

/// What is said of a job that runs; replaced where it is all that is said.
[[nodiscard]] std::span<const EnginePhrase> engine_stages();
/// What drivers say of their settings; likewise.
[[nodiscard]] std::span<const EnginePhrase> engine_settings();

/// What the engine says of a run, its scans and its wedges.
[[nodiscard]] std::span<const EnginePhrase> engine_phrases();
/// Of calibrations and artefacts.
[[nodiscard]] std::span<const EnginePhrase> engine_calibration();
/// What readers and registration remark on the files of others.
[[nodiscard]] std::span<const EnginePhrase> engine_remarks();
/// Of cameras.
[[nodiscard]] std::span<const EnginePhrase> engine_cameras();
/// Of stages and their controllers.
[[nodiscard]] std::span<const EnginePhrase> engine_controllers();
/// Of any device, and of what is put together of them.
[[nodiscard]] std::span<const EnginePhrase> engine_rigs();

/// The phrases of all these tables in the order in which they are replaced (text_table.h: translated()): the
/// longest first, for one may hold another.
[[nodiscard]] const std::vector<EnginePhrase>& engine_sentences();

}  // namespace dubsar::ui
