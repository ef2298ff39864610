// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/setting_widget.h"

namespace dubsar::ui {

bool setting_widget(UiContext& ui, const std::string& name, const SettingInfo& setting, std::string& value) {
  bool changed = false;
  std::string label = setting.unit.empty() ? setting.key : fmt::format("{} ({})", setting.key, setting.unit);
  if (setting.type == SettingType::kBool) {
    bool on = value == "1" || value == "true";
    if (tick(ui, name.c_str(), label.c_str(), on)) {
      value.assign(on ? 1 : 0, '1');
      changed = true;
    }
  } else if (setting.type == SettingType::kChoice) {
    ImGui::TextUnformatted(label.c_str());
    ImGui::SetNextItemWidth(-1);
    if (ImGui::BeginCombo(fmt::format("##{}", name).c_str(), value.c_str())) {
      for (const std::string& choice : setting.choices) {
        if (ImGui::Selectable(choice.c_str(), value == choice) && value != choice) {
          value = choice;
          changed = true;
        }
        ui.target(fmt::format("{}.{}", name, choice));
      }
      ImGui::EndCombo();
    }
    ui.target(name);
  } else {
    if (setting.range && setting.range->second < 1e9) {
      label += fmt::format("  {:g} - {:g}", setting.range->first, setting.range->second);
    }
    changed = text_line(ui, name.c_str(), label.c_str(), value);
  }
  if (!setting.help.empty()) {
    ImGui::PushFont(ui.fonts.small);
    coloured_text(ui.colours.faint, setting.help.c_str());
    ImGui::PopFont();
  }
  return changed;
}

}  // namespace dubsar::ui
