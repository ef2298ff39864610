// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <string>
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
/// And of themselves and the options of their addresses; likewise.
[[nodiscard]] std::span<const EnginePhrase> engine_options();

/// How the tablet is to be turned and pushed, and where an arm goes.
[[nodiscard]] std::span<const EnginePhrase> engine_turns();
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
/// Of drivers, their options and settings.
[[nodiscard]] std::span<const EnginePhrase> engine_drivers();
/// Of small files that cannot be read.
[[nodiscard]] std::span<const EnginePhrase> engine_files();
/// Of scans and meshes that cannot be read.
[[nodiscard]] std::span<const EnginePhrase> engine_shapes();
/// Of sessions, of their disk and of signatures.
[[nodiscard]] std::span<const EnginePhrase> engine_stored();
/// Of packages, and of what lies where one is to go.
[[nodiscard]] std::span<const EnginePhrase> engine_packages();

/// The phrases of all these tables in the order in which they are replaced (text_table.h: translated()): the
/// longest first, for one may hold another.
[[nodiscard]] const std::vector<EnginePhrase>& engine_sentences();

/// What is said around a name that stands in the middle of it; before the phrases are replaced.
[[nodiscard]] std::string with_german_names(const std::string& english);
/// "scan 4", "scans 4 and 5", "pin 4", "line 12", "5 bytes", and what the system says; after them.
[[nodiscard]] std::string with_german_numbers(const std::string& english);

}  // namespace dubsar::ui
