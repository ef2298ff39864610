// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/theme.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/utf8.h"
#include "station/settings_file.h"

namespace dubsar::ui {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> kFontFiles{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                                "/usr/share/fonts/dejavu/DejaVuSans.ttf",
                                                "/usr/share/fonts/TTF/DejaVuSans.ttf"};

ImVec4 im(const Eigen::Vector4f& c) {
  return {c.x(), c.y(), c.z(), c.w()};
}

}  // namespace

fs::path preferences_file() {
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && *config != '\0') {
    return fs::path(config) / "dubsar" / "window.conf";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    return fs::path(home) / ".config" / "dubsar" / "window.conf";
  }
  return {};
}

Preferences usual_preferences(float content_scale) {
  Preferences out;
  if (std::isfinite(content_scale) && content_scale > 0) {
    out.font_px = std::clamp(out.font_px * content_scale, kSmallestFontPx, kLargestFontPx);
  }
  return out;
}

Preferences read_preferences(const fs::path& file, Preferences usual) {
  Preferences out = std::move(usual);
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    const auto mark = line.find('=');
    if (mark == std::string::npos) {
      continue;
    }
    const std::string key(trimmed(line.substr(0, mark)));
    const std::string value(trimmed(line.substr(mark + 1)));
    if (key == "language") {
      out.language = language_of(value).value_or(out.language);
    } else if (key == "dark") {
      out.dark = value != "0";
    } else if (key == "blue_for_red") {
      out.blue_for_red = value == "1";
    } else if (key == "sound") {
      out.sound = value == "1";
    } else if (key == "font_px") {
      float px = 0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), px);
      if (error == std::errc() && std::isfinite(px)) {
        out.font_px = std::clamp(px, kSmallestFontPx, kLargestFontPx);
      }
    } else if (key == "operator") {
      out.operator_name = value;
    } else if (key == "device") {
      out.device = value;
    }
  }
  return out;
}

void write_preferences(const fs::path& file, const Preferences& preferences) {
  if (file.empty()) {
    return;
  }
  std::ostringstream out;
  out << "language = " << code_of(preferences.language) << "\ndark = " << preferences.dark
      << "\nblue_for_red = " << preferences.blue_for_red << "\nsound = " << preferences.sound
      << "\nfont_px = " << preferences.font_px << "\noperator = " << preferences.operator_name
      << "\ndevice = " << preferences.device << "\n";
  (void)write_settings_file(file, out.view());  // the window goes on without, and the last ones stay
}

Colours colours_of(const Preferences& preferences) {
  Colours c;
  if (preferences.blue_for_red) {  // Okabe and Ito 2008
    c.red = {0.00F, 0.45F, 0.90F, 1};
    c.bad = {0.84F, 0.37F, 0.00F, 1};  // blue asks, or is under-sampled
    c.outline = {0.48F, 0.17F, 0.00F, 1};
    c.amber = {0.90F, 0.62F, 0.00F, 1};
    c.good = {0.80F, 0.78F, 0.70F, 1};
  } else {
    c.red = c.bad = {0.90F, 0.16F, 0.18F, 1};
    c.outline = {0.10F, 0.24F, 0.50F, 1};
    c.amber = {0.89F, 0.63F, 0.16F, 1};
    c.good = {0.30F, 0.72F, 0.38F, 1};
  }
  c.ghost = {0.45F, 0.75F, 1.0F, 1};
  c.clay = {0.86F, 0.72F, 0.55F, 1};
  if (preferences.dark) {
    c.text = {0.94F, 0.93F, 0.90F, 1};
    c.faint = {0.62F, 0.61F, 0.58F, 1};
    c.panel = {0.13F, 0.135F, 0.15F, 1};
    c.strong = {0.20F, 0.42F, 0.68F, 1};
  } else {
    if (preferences.blue_for_red) {
      c.good = {0.35F, 0.33F, 0.25F, 1};
      c.bad = {0.70F, 0.15F, 0.00F, 1};
    } else {
      c.good = {0.10F, 0.50F, 0.20F, 1};
    }
    // Letters and arrows on a light ground need more ink.
    c.amber = {0.68F, 0.42F, 0.00F, 1};
    c.ghost = {0.05F, 0.40F, 0.80F, 1};
    c.text = {0.10F, 0.10F, 0.12F, 1};
    c.faint = {0.38F, 0.38F, 0.40F, 1};
    c.panel = {0.95F, 0.94F, 0.92F, 1};
    c.strong = {0.55F, 0.74F, 0.95F, 1};
  }
  return c;
}

Fonts load_fonts(float px) {
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  // Latin with its accents and those of transliteration (ḫ, ṣ, ṭ, ʾ, sign numbers such as du₃), Greek,
  // Cyrillic, Hebrew and Arabic with its joined forms (archive/seen_line.h) for names, general punctuation
  // and arrows.
  static const ImWchar kRanges[] = {0x0020, 0x017F, 0x0218, 0x021B, 0x02BE, 0x02BF, 0x0370, 0x03FF,
                                    0x0400, 0x045F, 0x0490, 0x0491, 0x0590, 0x06FF, 0x1E0C, 0x1E6F,
                                    0x2010, 0x203A, 0x2070, 0x209F, 0x2190, 0x21FF, 0x25A0, 0x25FF,
                                    0x2713, 0x2717, 0xFB1D, 0xFBFF, 0xFE70, 0xFEFC, 0};
  Fonts fonts;
  for (const char* file : kFontFiles) {
    std::error_code error;
    if (!fs::exists(file, error)) {
      continue;
    }
    fonts.normal = io.Fonts->AddFontFromFileTTF(file, px, nullptr, kRanges);
    fonts.large = io.Fonts->AddFontFromFileTTF(file, 1.7F * px, nullptr, kRanges);
    fonts.small = io.Fonts->AddFontFromFileTTF(file, 0.8F * px, nullptr, kRanges);
    break;
  }
  if (fonts.normal == nullptr) {
    ImFontConfig config;
    config.SizePixels = px;
    fonts.normal = io.Fonts->AddFontDefault(&config);
    config.SizePixels = 1.7F * px;
    fonts.large = io.Fonts->AddFontDefault(&config);
    config.SizePixels = 0.8F * px;
    fonts.small = io.Fonts->AddFontDefault(&config);
  }
  return fonts;
}

void apply_theme(const Preferences& preferences) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (preferences.dark) {
    ImGui::StyleColorsDark();
  } else {
    ImGui::StyleColorsLight();
  }
  const float px = preferences.font_px;
  style.WindowRounding = 0;
  style.FrameRounding = 5;
  style.WindowBorderSize = 0;
  style.ChildRounding = 6;
  style.WindowPadding = {0.55F * px, 0.5F * px};
  style.FramePadding = {0.5F * px, 0.42F * px};  // a gloved finger needs room
  style.ItemSpacing = {0.45F * px, 0.4F * px};
  style.ScrollbarSize = px;
  const Colours c = colours_of(preferences);
  if (!preferences.dark) {  // white boxes to tick cannot be seen on a light ground
    style.Colors[ImGuiCol_FrameBg] = {0.82F, 0.82F, 0.80F, 1};
    style.Colors[ImGuiCol_FrameBgHovered] = {0.76F, 0.80F, 0.86F, 1};
    style.Colors[ImGuiCol_CheckMark] = {0.10F, 0.35F, 0.70F, 1};
  }
  style.Colors[ImGuiCol_WindowBg] = im(c.panel);
  style.Colors[ImGuiCol_PopupBg] = im(c.panel);
  style.Colors[ImGuiCol_Text] = im(c.text);
  style.Colors[ImGuiCol_TextDisabled] = im(c.faint);
  style.Colors[ImGuiCol_PlotHistogram] = im(c.strong);  // bars, whose words are read on them
  style.Colors[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.45F};
}

}  // namespace dubsar::ui
