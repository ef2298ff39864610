// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "ui/shell/text_table.h"

struct ImFont;

namespace dubsar::ui {

/// What an operator has chosen of the window; kept between runs.
struct Preferences {
  Language language = Language::kEnglish;
  bool dark = true;
  bool blue_for_red = false;  ///< red and amber as blue and orange: told apart by the colour-blind
  bool sound = false;         ///< a tone when something is done or failed
  float font_px = 18;
  std::string operator_name;
  std::string device;  ///< URI that was used last

  [[nodiscard]] Wording wording() const { return {language, blue_for_red}; }
  bool operator==(const Preferences&) const = default;
};

inline constexpr float kSmallestFontPx = 14;
inline constexpr float kLargestFontPx = 32;

/// $XDG_CONFIG_HOME/dubsar/window.conf, or under ~/.config; empty when there is neither.
[[nodiscard]] std::filesystem::path preferences_file();
/// Those of an operator who has chosen nothing yet, on a display that is set to show things so many times as
/// large as usual (GLFW's content scale; what is no scale counts as 1).
[[nodiscard]] Preferences usual_preferences(float content_scale);
/// Lines "key = value"; what is not understood is skipped, and what is not there is as `usual`.
[[nodiscard]] Preferences read_preferences(const std::filesystem::path& file, Preferences usual = {});
/// Best effort: the window works without.
void write_preferences(const std::filesystem::path& file, const Preferences& preferences);

/// Colours that mean something, by preference. `red`: what is under-sampled; `bad`: what went wrong;
/// `outline`: the outer edges of wedges.
struct Colours {
  Eigen::Vector4f red, bad, outline, amber, good, ghost, clay, faint, text, panel, strong;
};
[[nodiscard]] Colours colours_of(const Preferences& preferences);

struct Fonts {
  ImFont* normal = nullptr;
  ImFont* large = nullptr;
  ImFont* small = nullptr;
};

/// Sets style and sizes; makes the fonts when their size has changed (before a frame begins).
void apply_theme(const Preferences& preferences);
[[nodiscard]] Fonts load_fonts(float px);

}  // namespace dubsar::ui
