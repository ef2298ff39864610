// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/device_dialog.h"

#include <algorithm>
#include <chrono>

#include "ui/gl/gl_window.h"
#include "ui/operator/setting_widget.h"

namespace dubsar::ui {

namespace {

constexpr const char* kPopup = "###devices";

}  // namespace

void DeviceDialog::look() {
  looking_ = std::async(std::launch::async, [] {
    auto drivers = offered_drivers();
    wake_window();
    return drivers;
  });
}

void DeviceDialog::open(const std::string& current_uri) {
  open_ = true;
  uri_ = current_uri;
  if (!known_ && !looking_.valid()) {
    look();
  }
}

std::optional<std::string> DeviceDialog::draw(UiContext& ui) {
  if (open_) {
    ImGui::OpenPopup(kPopup);
    open_ = false;
  }
  if (looking_.valid() && looking_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    drivers_ = looking_.get();
    known_ = true;
    chosen_ = std::min(chosen_, drivers_.empty() ? 0 : drivers_.size() - 1);
  }
  std::optional<std::string> out;
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSize({std::min(window.x * 0.9F, ui.px(56)), window.y * 0.86F});
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  if (!ImGui::BeginPopupModal(fmt::format("{}{}", ui.text(Text::kDevice), kPopup).c_str(), nullptr,
                              ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    return out;
  }
  ui.facts.insert("dialog");
  const float foot = ImGui::GetFrameHeightWithSpacing() * 3 + ui.px(0.6F);
  ImGui::BeginChild("drivers", {ui.px(17), -foot}, true);
  if (!known_) {
    ImGui::TextUnformatted("...");
  }
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const OfferedDriver& driver = drivers_[k];
    ImGui::PushID(static_cast<int>(k));
    if (ImGui::Selectable(fmt::format("{}:", driver.scheme).c_str(), chosen_ == k, 0,
                          {0, ImGui::GetFrameHeight()})) {
      chosen_ = k;
      values_.clear();
      locator_.clear();
      uri_ = fmt::format("{}:", driver.scheme);
    }
    ui.target(fmt::format("driver.{}", driver.scheme));
    for (const auto& [uri, description] : driver.found) {
      if (ImGui::Selectable(fmt::format("   {}", description).c_str(), uri_ == uri, 0,
                            {0, ImGui::GetFrameHeight()})) {
        chosen_ = k;
        uri_ = uri;
      }
      ui.target(fmt::format("device.{}", uri));
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("options", {0, -foot}, true);
  if (chosen_ < drivers_.size()) {
    const OfferedDriver& driver = drivers_[chosen_];
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(driver.description.c_str());
    if (!driver.trouble.empty()) {
      coloured_text(ui.colours.red, driver.trouble.c_str());
    }
    ImGui::PopTextWrapPos();
    const auto before = std::pair(locator_, values_);
    if (!driver.locator_help.empty()) {
      text_line(ui, "locator", driver.locator_help.c_str(), locator_);
    }
    for (const SettingInfo& option : driver.options) {
      setting_widget(ui, fmt::format("option.{}", option.key), option, values_[option.key]);
    }
    if (before != std::pair(locator_, values_)) {
      uri_ = compose_uri(driver.scheme, locator_, {values_.begin(), values_.end()});
    }
  }
  ImGui::EndChild();
  text_line(ui, "uri", ui.text(Text::kAddress), uri_);
  if (plain_button(ui, "use-device", ui.text(Text::kUse), !uri_.empty())) {
    out = uri_;
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (plain_button(ui, "look-again", ui.text(Text::kLookAgain), !looking_.valid())) {
    look();
  }
  ImGui::SameLine();
  if (plain_button(ui, "close-devices", ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  return out;
}

}  // namespace dubsar::ui
