// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/setting_widget.h"

#include <algorithm>
#include <vector>

#include "ui/shell/typed_number.h"

namespace dubsar::ui {

namespace {

struct Choice {
  std::string value;
  std::string words;
};

bool choose_one(UiContext& ui, const std::string& name, const std::vector<Choice>& choices,
                std::string& value) {
  bool changed = false;
  const auto now = std::ranges::find(choices, value, &Choice::value);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo(fmt::format("##{}", name).c_str(),
                        now != choices.end() ? now->words.c_str() : value.c_str())) {
    for (const Choice& choice : choices) {
      if (ImGui::Selectable(choice.words.c_str(), value == choice.value) && value != choice.value) {
        value = choice.value;
        changed = true;
      }
      ui.target(fmt::format("{}.{}", name, choice.value));
    }
    ImGui::EndCombo();
  }
  ui.target(name);
  return changed;
}

}  // namespace

std::string driver_word(const SettingInfo& setting, const std::string& value) {
  const bool is_number = setting.type == SettingType::kNumber || setting.type == SettingType::kInteger;
  return is_number ? number_word(value) : value;
}

bool setting_widget(UiContext& ui, const std::string& name, const SettingInfo& setting, std::string& value,
                    MaySay may) {
  bool changed = false;
  std::vector<Choice> choices;
  if (may == MaySay::kNothing) {  // the driver's default is not known here: a tick would say what is not so
    choices.push_back({"", ui.text(Text::kAsUsual)});
  }
  std::string label = setting.unit.empty() ? setting.key : fmt::format("{} ({})", setting.key, setting.unit);
  if (setting.type == SettingType::kBool && may == MaySay::kNothing) {
    ImGui::TextUnformatted(label.c_str());
    choices.push_back({"1", ui.text(Text::kOn)});
    choices.push_back({"0", ui.text(Text::kOff)});
    changed = choose_one(ui, name, choices, value);
  } else if (setting.type == SettingType::kBool) {
    bool on = value == "1" || value == "true";
    if (tick(ui, name.c_str(), label.c_str(), on)) {
      value.assign(on ? 1 : 0, '1');
      changed = true;
    }
  } else if (setting.type == SettingType::kChoice) {
    ImGui::TextUnformatted(label.c_str());
    for (const std::string& choice : setting.choices) {
      choices.push_back({choice, choice});
    }
    changed = choose_one(ui, name, choices, value);
  } else {
    if (setting.range && setting.range->second < 1e9) {
      label += decimal(fmt::format("  {:g} - {:g}", setting.range->first, setting.range->second),
                       ui.preferences.language);
    }
    changed = text_line(ui, name.c_str(), label.c_str(), value);
  }
  if (!setting.help.empty()) {
    ImGui::PushFont(ui.fonts.small);
    coloured_text(ui.colours.faint, translated(setting.help, ui.preferences.language).c_str());
    ImGui::PopFont();
  }
  return changed;
}

}  // namespace dubsar::ui
