// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar::ui {

enum class Sound { kDone, kFailed };

/// A short tone as a WAV file (16 bit, mono): two rising notes when something is done, two falling ones when
/// it failed, so that both are told apart without looking.
[[nodiscard]] std::vector<std::uint8_t> tone_of(Sound sound);

/// Plays it with what the desktop has for that (pw-play, paplay or aplay), or the terminal's bell; returns at
/// once. Best effort: a station without a loudspeaker works as well.
void play(Sound sound);

}  // namespace dubsar::ui
