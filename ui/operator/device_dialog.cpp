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
  take(current_uri);
  if (!known_ && !looking_.valid()) {
    look();
  }
}

/// Goes on from the address that is in use.
void DeviceDialog::take(const std::string& uri) {
  uri_ = uri;
  locator_.clear();
  values_.clear();
  chosen_ = drivers_.size();
  const std::optional<UriParts> parts = uri_parts(uri);
  if (!parts) {
    return;
  }
  locator_ = parts->locator;
  for (const auto& [key, value] : parts->options) {
    values_[key] = value;
  }
  chosen_ = static_cast<std::size_t>(std::ranges::find(drivers_, parts->scheme, &OfferedDriver::scheme) -
                                     drivers_.begin());
}

void DeviceDialog::draw_choices(UiContext& ui) {
  if (!known_) {
    ImGui::TextUnformatted("...");
  }
  // What is plugged in comes first: that is what most come for.
  const auto line = [&](const std::string& title, const std::string& words, bool is_chosen) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float room = ImGui::GetContentRegionAvail().x;
    const float pad = ui.px(0.3F);
    ImFont* small = ui.fonts.small;
    const float below =
        words.empty() ? 0
                      : small->CalcTextSizeA(small->FontSize, 1e6F, room - 2 * pad, words.c_str(), nullptr).y;
    const float above = ImGui::CalcTextSize(title.c_str(), nullptr, false, room - 2 * pad).y;
    const bool hit = ImGui::Selectable("##choice", is_chosen, 0, {0, above + below + 2 * pad});
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddText(nullptr, 0, {at.x + pad, at.y + pad}, packed(ui.colours.text), title.c_str(), nullptr,
                  room - 2 * pad);
    // Faint letters cannot be read on the blue of what is chosen.
    draw->AddText(small, small->FontSize, {at.x + pad, at.y + pad + above},
                  packed(is_chosen ? ui.colours.text : ui.colours.faint), words.c_str(), nullptr,
                  room - 2 * pad);
    return hit;
  };
  const bool any = std::ranges::any_of(drivers_, [](const OfferedDriver& d) { return !d.found.empty(); });
  if (known_) {
    coloured_text(ui.colours.faint, ui.text(any ? Text::kFound : Text::kNothingFound));
  }
  for (const OfferedDriver& driver : drivers_) {
    for (const auto& [uri, description] : driver.found) {
      ImGui::PushID(uri.c_str());
      if (line(translated(description, ui.preferences.language), uri, uri_ == uri)) {
        take(uri);
      }
      ImGui::PopID();
      ui.target(fmt::format("device.{}", uri));
    }
  }
  if (any) {
    ImGui::Separator();
  }
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const OfferedDriver& driver = drivers_[k];
    ImGui::PushID(static_cast<int>(k));
    const std::string words = translated(driver.description, ui.preferences.language);
    if (line(fmt::format("{}:", driver.scheme), words, chosen_ == k) && chosen_ != k) {
      take(fmt::format("{}:", driver.scheme));
    }
    ImGui::PopID();
    ui.target(fmt::format("driver.{}", driver.scheme));
  }
}

void DeviceDialog::draw_options(UiContext& ui) {
  if (chosen_ >= drivers_.size()) {
    return;
  }
  const OfferedDriver& driver = drivers_[chosen_];
  ImGui::PushTextWrapPos(0);
  const auto in_words = [&ui](const std::string& text) { return translated(text, ui.preferences.language); };
  ImGui::TextUnformatted(in_words(driver.description).c_str());
  if (!driver.trouble.empty()) {
    coloured_text(ui.colours.bad, in_words(driver.trouble).c_str());
  }
  ImGui::PopTextWrapPos();
  bool changed = false;
  if (!driver.locator_help.empty()) {
    changed = text_line(ui, "locator", in_words(driver.locator_help).c_str(), locator_);
  }
  for (const SettingInfo& option : driver.options) {
    changed = setting_widget(ui, fmt::format("option.{}", option.key), option, values_[option.key],
                             MaySay::kNothing) ||
              changed;
  }
  if (changed) {
    std::vector<std::pair<std::string, std::string>> options{values_.begin(), values_.end()};
    for (auto& [key, value] : options) {
      const auto option = std::ranges::find(driver.options, key, &SettingInfo::key);
      value = option == driver.options.end() ? value : driver_word(*option, value);
    }
    uri_ = compose_uri(driver.scheme, locator_, options);
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
    take(uri_);
  }
  std::optional<std::string> out;
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSize({std::min(window.x * 0.9F, ui.px(56)), window.y * 0.86F});
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  if (!ImGui::BeginPopupModal(fmt::format("{}{}", ui.text(Text::kDevice), kPopup).c_str(), nullptr,
                              ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    return out;
  }
  begin_asking(ui);
  const float foot = 2 * ImGui::GetFrameHeightWithSpacing() + ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("drivers", {ui.px(17), -foot}, true);
  draw_choices(ui);
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("options", {0, -foot}, true);
  draw_options(ui);
  ImGui::EndChild();
  if (text_line(ui, "uri", ui.text(Text::kAddress), uri_)) {
    const std::string typed = uri_;
    take(typed);
  }
  ui.facts.insert(fmt::format("address.{}", uri_));
  if (confirmed(ui, "use-device", Text::kUse, !uri_.empty())) {
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
