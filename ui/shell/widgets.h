// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fmt/format.h>
#include <imgui.h>

#include <cstdint>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ui/shell/decimal_comma.h"
#include "ui/shell/frame_watch.h"
#include "ui/shell/key_focus.h"
#include "ui/shell/theme.h"
#include "ui/shell/time_left.h"

namespace dubsar::ui {

/// What the panels share during a frame: texts, colours, and the record of what can be pressed where, which a
/// script goes by.
struct UiContext {
  Preferences preferences;
  Colours colours;
  Fonts fonts;
  std::map<std::string, ImVec4> targets;  ///< rectangle by name, of the last frame
  std::set<std::string> facts;            ///< what is the case, for a script to wait for
  bool still = false;                     ///< a script runs: nothing moves by itself
  double time_s = 0;
  FrameWatch watch;
  KeyFocus keys;

  [[nodiscard]] const char* text(Text which) const { return text_of(which, preferences.wording()); }
  /// Notes where the last item is, under a name for scripts, and whether nothing of it is cut off; keys reach
  /// it. True where the frame of the keyboard is round it.
  bool target(const std::string& name, Reach reach = Reach::kPressed);
  [[nodiscard]] float px(float fonts_high) const { return fonts_high * preferences.font_px; }
};

/// The beginning of a text that is too long for a width in the letters of now, with dots at its end.
[[nodiscard]] std::string shortened(const std::string& text, float width_px);

enum class ButtonKind { kPlain, kMain, kDanger };

/// A button large enough for a glove, known to scripts by its name. The key that does the same is shown on
/// it. A label that is too long for it is in the small letters, and its end is left out where those are.
bool big_button(UiContext& ui, const char* name, const char* label, const char* key, ImVec2 size,
                ButtonKind kind = ButtonKind::kPlain, bool enabled = true);
bool plain_button(UiContext& ui, const char* name, const char* label, bool enabled = true);
/// A line to type in; true when it was changed.
bool text_line(UiContext& ui, const char* name, const char* label, std::string& value);
/// The same without a label, so wide.
bool short_text(UiContext& ui, const char* name, std::string& value, float width);
bool tick(UiContext& ui, const char* name, const char* label, bool& value);
/// The texture of this name in OpenGL, as ImGui wants it.
[[nodiscard]] inline ImTextureID picture_of(unsigned texture) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): a name in a pointer's clothes; it is never followed
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
}
/// A box over nearly the whole window that keeps all else waiting; `opening` is taken up. False when it is
/// shut; ImGui::EndPopup() ends it.
[[nodiscard]] bool begin_wide_box(UiContext& ui, const char* title, const char* id, bool& opening,
                                  ImVec2 of_window = {0.94F, 0.92F});
/// One of these keys of GLFW went down.
[[nodiscard]] bool any_pressed(std::initializer_list<int> keys);
/// The enter key went down, and is not for what the frame of the keyboard is round.
[[nodiscard]] bool enter_pressed(const UiContext& ui);
/// The keys and the pedal that have opened a box do what it is for when they are pressed again. In a line
/// that is typed into, end goes to its end.
[[nodiscard]] bool confirms(const UiContext& ui);
/// The button that a box is for: those keys press it too.
bool confirmed(UiContext& ui, const char* name, Text text, bool enough = true);
/// To be said at the beginning of every box that is open: keys go to it alone, and escape shuts it.
void begin_asking(UiContext& ui);
/// One of several numbers, in as many rows as they take; true when another was chosen.
bool one_of(UiContext& ui, const std::string& name, const std::vector<int>& ids, int& chosen);
/// Rows that one_of() takes in such a width.
[[nodiscard]] float rows_of(const std::vector<int>& ids, float width);
/// How far a job is with what it is at, and below how long that will take.
void job_bar(UiContext& ui, TimeLeft& left, const std::string& stage, double fraction);
void coloured_text(const Eigen::Vector4f& colour, const char* text);
/// A text of the table with its gaps filled in; numbers that are marked so ({:.1Lf}) with a decimal comma.
template <class... Arguments>
[[nodiscard]] std::string filled(const char* format, const Arguments&... arguments) {
  return fmt::vformat(with_comma(), format, fmt::make_format_args(arguments...));
}
[[nodiscard]] ImU32 packed(const Eigen::Vector4f& colour, float alpha = 1.0F);
/// "1 234 567"
[[nodiscard]] std::string grouped(std::size_t number);

}  // namespace dubsar::ui
