// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/widgets.h"

#include <GLFW/glfw3.h>

#include <algorithm>

#include "archive/seen_line.h"
#include "core/utf8.h"
#include "ui/shell/typed_signs.h"

namespace dubsar::ui {

namespace {

/// Grows the string as it is typed into.
int grow(ImGuiInputTextCallbackData* data) {
  if (data->EventFlag == ImGuiInputTextFlags_CallbackResize) {
    auto* text = static_cast<std::string*>(data->UserData);
    text->resize(static_cast<std::size_t>(data->BufTextLen));
    data->Buf = text->data();
  }
  return 0;
}

/// Over all else, in two colours of which one is seen on any ground.
void draw_frame(const UiContext& ui, ImVec2 low, ImVec2 high) {
  constexpr float kBeside = 3;
  ImDrawList* draw = ImGui::GetForegroundDrawList();
  const ImVec2 first = ImGui::GetWindowDrawList()->GetClipRectMin();
  const ImVec2 last = ImGui::GetWindowDrawList()->GetClipRectMax();
  const ImVec2 from{std::max(low.x, first.x) - kBeside, std::max(low.y, first.y) - kBeside};
  const ImVec2 to{std::min(high.x, last.x) + kBeside, std::min(high.y, last.y) + kBeside};
  const float rounding = ImGui::GetStyle().FrameRounding;
  draw->AddRect(from, to, packed(ui.colours.panel), rounding, 0, 6);
  draw->AddRect(from, to, packed(ui.colours.text), rounding, 0, 3);
}

}  // namespace

bool UiContext::target(const std::string& name, Reach reach) {
  const ImVec2 low = ImGui::GetItemRectMin();
  const ImVec2 high = ImGui::GetItemRectMax();
  targets[name] = {low.x, low.y, high.x, high.y};
  const ImVec2 first = ImGui::GetWindowDrawList()->GetClipRectMin();
  const ImVec2 last = ImGui::GetWindowDrawList()->GetClipRectMax();
  if (low.x >= first.x && low.y >= first.y && high.x <= last.x && high.y <= last.y) {
    facts.insert("whole." + name);
  }
  const bool framed = keys.item(reach);
  if (framed) {
    facts.insert("framed." + name);
    draw_frame(*this, low, high);
  }
  return framed;
}

ImU32 packed(const Eigen::Vector4f& c, float alpha) {
  return ImGui::ColorConvertFloat4ToU32({c.x(), c.y(), c.z(), c.w() * alpha});
}

std::string grouped(std::size_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) {
      text += ' ';
    }
    text += digits[k];
  }
  return text;
}

std::string shortened(const std::string& text, float width_px) {
  std::string out = text;
  for (std::size_t kept = text.size(); kept > 0 && ImGui::CalcTextSize(out.c_str()).x > width_px;) {
    do {  // a whole letter of UTF-8
      --kept;
    } while (kept > 0 && (static_cast<unsigned char>(text[kept]) & 0xC0U) == 0x80U);
    out = text.substr(0, kept) + "...";
  }
  return out;
}

bool big_button(UiContext& ui, const char* name, const char* label, const char* key, ImVec2 size,
                ButtonKind kind, bool enabled) {
  const bool coloured = kind != ButtonKind::kPlain && enabled;
  const bool danger = kind == ButtonKind::kDanger;
  if (coloured) {
    // Danger is red whatever the operator has chosen in place of it.
    const Eigen::Vector4f c = danger ? Eigen::Vector4f(0.78F, 0.08F, 0.08F, 1) : ui.colours.strong;
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(c.x(), c.y(), c.z(), 1));
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImVec4(c.x() * 1.15F, c.y() * 1.15F, c.z() * 1.15F, 1));
  }
  ImGui::BeginDisabled(!enabled);
  ImGui::PushID(name);
  const bool pressed = ImGui::Button("##press", size);
  ImGui::PopID();
  ImGui::EndDisabled();
  if (enabled) {
    ui.target(name);
  }
  if (coloured) {
    ImGui::PopStyleColor(2);
  }
  const ImVec2 low = ImGui::GetItemRectMin();
  const ImVec2 high = ImGui::GetItemRectMax();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const bool in_small = ImGui::CalcTextSize(label).x > high.x - low.x - ui.px(0.4F);
  if (in_small) {
    ImGui::PushFont(ui.fonts.small);
  }
  const std::string cut = shortened(label, high.x - low.x - ui.px(0.4F));
  const std::string shown = seen_line(cut);
  if (cut != label && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    ImGui::SetTooltip("%s", seen_line(label).c_str());
  }
  const ImVec2 label_size = ImGui::CalcTextSize(shown.c_str());
  const float small = ui.fonts.small->FontSize;
  const float height = label_size.y + (key != nullptr ? small : 0.0F);
  const float middle = 0.5F * (low.x + high.x);
  float y = 0.5F * (low.y + high.y - height);
  const Eigen::Vector4f letters = danger ? Eigen::Vector4f(1, 1, 1, 1) : ui.colours.text;
  const ImU32 ink = packed(enabled ? letters : ui.colours.faint);
  draw->AddText({middle - 0.5F * label_size.x, y}, ink, shown.c_str());
  if (in_small) {
    ImGui::PopFont();
  }
  if (key != nullptr) {
    y += label_size.y;
    const ImVec2 key_size = ui.fonts.small->CalcTextSizeA(small, 1e4F, 0, key);
    // Faint letters cannot be read on a button's blue.
    const ImU32 key_ink = enabled ? packed(letters, 0.85F) : packed(ui.colours.faint);
    draw->AddText(ui.fonts.small, small, {middle - 0.5F * key_size.x, y}, key_ink, key);
  }
  return pressed;
}

bool plain_button(UiContext& ui, const char* name, const char* label, bool enabled) {
  ImGui::BeginDisabled(!enabled);
  ImGui::PushID(name);
  const bool pressed = ImGui::Button(fmt::format("{}###press", label).c_str());  // one button in any words
  ImGui::PopID();
  ImGui::EndDisabled();
  if (enabled) {
    ui.target(name);
  }
  return pressed;
}

bool text_line(UiContext& ui, const char* name, const char* label, std::string& value) {
  ImGui::TextUnformatted(label);
  // What is typed stands in the line letter by letter; whoever writes from right to left reads it here.
  if (const std::string seen = seen_line(value); seen != value) {
    ImGui::SameLine(0, ui.px(1));
    coloured_text(ui.colours.ghost, seen.c_str());
  } else if (stand_ins_of(value) != as_utf8(value)) {
    ImGui::SameLine(0, ui.px(1));
    coloured_text(ui.colours.ghost, ui.text(Text::kSignsKept));
  }
  return short_text(ui, name, value, -1);
}

bool short_text(UiContext& ui, const char* name, std::string& value, float width) {
  ImGui::PushID(name);
  ImGui::SetNextItemWidth(width);
  std::string line = stand_ins_of(value);
  const std::string typed = line;
  bool changed = ImGui::InputText(
      "##text", line.data(), line.capacity() + 1,
      ImGuiInputTextFlags_CallbackResize |
          (can_be_typed_into(value) ? ImGuiInputTextFlags_None : ImGuiInputTextFlags_ReadOnly),
      grow, &line);
  if (ImGui::IsItemDeactivated() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    line = typed;  // escape leaves a line, ImGui would put back what stood there before
    changed = true;
  }
  if (changed) {
    value = one_line(signs_of(line.c_str()));
  }
  ui.target(name, Reach::kTyped);
  ImGui::PopID();
  return changed;
}

bool tick(UiContext& ui, const char* name, const char* label, bool& value) {
  ImGui::PushID(name);
  const bool changed = ImGui::Checkbox(fmt::format("{}###tick", label).c_str(), &value);
  ImGui::PopID();
  ui.target(name);
  return changed;
}

bool begin_wide_box(UiContext& ui, const char* title, const char* id, bool& opening, ImVec2 of_window) {
  if (opening) {
    ImGui::OpenPopup(id);
    opening = false;
  }
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSize({window.x * of_window.x, window.y * of_window.y});
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  if (!ImGui::BeginPopupModal((std::string(title) + id).c_str(), nullptr,
                              ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    return false;
  }
  begin_asking(ui);
  return true;
}

bool any_pressed(std::initializer_list<int> keys) {
  return std::ranges::any_of(keys, [](int key) { return ImGui::IsKeyPressed(key, false); });
}

bool enter_pressed(const UiContext& ui) {
  return !ui.keys.takes_enter() && any_pressed({GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER});
}

bool confirms(const UiContext& ui) {
  // A list that has dropped down is over the box: enter is not for what is below it.
  return !ImGui::IsWindowAppearing() && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) &&
         (enter_pressed(ui) || any_pressed({GLFW_KEY_F11}) ||
          (!ImGui::GetIO().WantTextInput && any_pressed({GLFW_KEY_END})));
}

bool confirmed(UiContext& ui, const char* name, Text text, bool enough) {
  const bool by_key = enough && confirms(ui);
  return plain_button(ui, name, ui.text(text), enough) || by_key;
}

void begin_asking(UiContext& ui) {
  ui.facts.insert("dialog");
  // An escape that leaves a line that is typed into leaves only that.
  const bool typing = ImGui::IsAnyItemActive() || ImGui::GetIO().WantTextInput;
  if (!typing && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) &&
      ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    ImGui::CloseCurrentPopup();
  }
}

bool one_of(UiContext& ui, const std::string& name, const std::vector<int>& ids, int& chosen) {
  bool changed = false;
  const float end = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const std::string label = std::to_string(ids[k]);
    const float wide =
        ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(label.c_str()).x;
    if (k > 0 && ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + wide <= end) {
      ImGui::SameLine();
    }
    if (ImGui::RadioButton(label.c_str(), ids[k] == chosen) && ids[k] != chosen) {
      chosen = ids[k];
      changed = true;
    }
    ui.target(name + "." + label);
  }
  return changed;
}

float rows_of(const std::vector<int>& ids, float width) {
  float rows = ids.empty() ? 0 : 1;
  float x = 0;
  for (const int id : ids) {
    const float wide = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x +
                       ImGui::CalcTextSize(std::to_string(id).c_str()).x;
    if (x > 0 && x + ImGui::GetStyle().ItemSpacing.x + wide > width) {
      rows += 1;
      x = 0;
    }
    x += (x > 0 ? ImGui::GetStyle().ItemSpacing.x : 0) + wide;
  }
  return rows;
}

void job_bar(UiContext& ui, TimeLeft& left, const std::string& stage, double fraction) {
  ImGui::ProgressBar(static_cast<float>(fraction), {-1, ImGui::GetFrameHeight()},
                     translated(stage, ui.preferences.language).c_str());
  ui.target("job");
  if (const std::optional<double> seconds = left.of(stage, fraction, ui.time_s)) {
    ImGui::TextUnformatted(filled(ui.text(Text::kTimeLeft), *seconds).c_str());
    ui.target("time-left");
  }
}

void coloured_text(const Eigen::Vector4f& c, const char* text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(c.x(), c.y(), c.z(), c.w()));
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

}  // namespace dubsar::ui
