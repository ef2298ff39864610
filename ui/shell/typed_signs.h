// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace dubsar::ui {

/// ImGui (as Debian has it) holds characters in 16 bits: what lies above U+FFFF, and all of cuneiform does,
/// becomes U+FFFD in a line that is typed into. There each such sign is stood in for by a Hangul syllable,
/// for the window's letters have none and ImGui takes no private characters that are typed; so is each of
/// those themselves, to be told from them. Which stands for which is kept as long as the program runs. For
/// the thread that draws.
/// @return the sign itself below U+10000 unless it is such a syllable, and U+FFFD once 11 172 others were
/// seen
[[nodiscard]] std::uint32_t stand_in_of(std::uint32_t sign);

/// Of a whole line; what is no UTF-8 becomes U+FFFD.
[[nodiscard]] std::string stand_ins_of(std::string_view line);
/// The line that those stand for.
[[nodiscard]] std::string signs_of(std::string_view stand_ins);
/// Whether the signs of a line come back from their stand-ins: not once there are too many.
[[nodiscard]] bool can_be_typed_into(std::string_view line);

}  // namespace dubsar::ui
