// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "station/live_state.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {

enum class Tone { kPlain, kHandsOff, kAsk, kWarn, kGood, kBad };

/// The one thing that the operator is told: what to do next. And which of the three main actions would do
/// something now.
struct Statement {
  std::string headline;
  std::string detail;
  Tone tone = Tone::kPlain;
  bool may_scan = false;
  bool may_undo = false;
  bool may_sign = false;
  bool may_finish = false;
  bool may_stop = false;
  bool may_pack = false;   ///< it is signed: the package
  bool may_next = false;   ///< likewise: the next tablet, in place of another scan
  bool may_halt = false;   ///< something moves, or a laser is lit
  bool may_point = false;  ///< places in two scans settle where the last one lies
  Text scan_label = Text::kScan;
};

[[nodiscard]] Statement statement_of(const LiveState& state, bool has_device, Wording wording);

/// The scan whose very samples this one has, and as which it counts; nothing where it counts itself, or is
/// not judged yet.
[[nodiscard]] std::optional<int> copy_of(const LiveState& state, const LiveScan& scan);

/// The scan that *Undo* takes out; null where none stands.
[[nodiscard]] const LiveScan* newest_standing(const LiveState& state);

/// What is wrong with a scan although it is in the model, as a sentence; empty where nothing is.
[[nodiscard]] std::string scan_warning(const LiveScan& scan, Language language);

/// How well it is known where the scan lies; empty where that is not in question: it is not registered, or it
/// gives the frame itself.
[[nodiscard]] std::string place_words(const LiveScan& scan, Language language);

}  // namespace dubsar::ui
