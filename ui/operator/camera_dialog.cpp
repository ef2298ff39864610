// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/camera_dialog.h"

#include <algorithm>
#include <utility>

#include "ui/operator/setting_widget.h"

namespace dubsar::ui {

namespace {

constexpr const char* kPopup = "###camera";
/// Of the hatch, in pixels of the picture.
constexpr int kHatchPeriod = 6;
constexpr int kHatchLine = 3;

/// By the click that chooses it; what is typed waits for its button.
bool is_put_at_once(const SettingInfo& setting) {
  return setting.type == SettingType::kBool || setting.type == SettingType::kChoice;
}

}  // namespace

std::vector<unsigned char> hatched(const CameraView& view) {
  constexpr std::array<unsigned char, 3> kSaturated{230, 159, 0};
  constexpr std::array<unsigned char, 3> kDark{86, 180, 233};
  std::vector<unsigned char> out(3 * view.grey.size());
  for (int v = 0; v < view.height; ++v) {
    for (int u = 0; u < view.width; ++u) {
      const std::size_t i =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(u);
      const bool rising = (u + v) % kHatchPeriod < kHatchLine;
      const bool falling = (u + (kHatchPeriod - 1) * v) % kHatchPeriod < kHatchLine;
      for (std::size_t k = 0; k < 3; ++k) {
        const bool saturated = view.mark[i] == PixelMark::kSaturated;
        const bool dark = view.mark[i] == PixelMark::kDark;
        out[3 * i + k] = saturated && rising ? kSaturated[k] : dark && falling ? kDark[k] : view.grey[i];
      }
    }
  }
  return out;
}

std::string exposure_line(const Exposure& is, Language language) {
  const bool too_long = is.advice == ExposureAdvice::kTooLong;
  const bool too_short = is.advice == ExposureAdvice::kTooShort;
  if (is.has_stripe) {
    return too_long ? filled(text_of(Text::kStripeTooLong, language), 100 * is.saturated_share)
           : too_short
               ? filled(text_of(Text::kStripeTooShort, language), 100 * is.dark_share)
               : filled(text_of(Text::kStripeGood, language), 100 * is.saturated_share, 100 * is.dark_share);
  }
  return too_long    ? filled(text_of(Text::kPhotographTooLong, language), 100 * is.saturated_share)
         : too_short ? text_of(Text::kPhotographTooShort, language)
                     : filled(text_of(Text::kPhotographGood, language), 100 * is.saturated_share);
}

void CameraDialog::draw_view(UiContext& ui, ImVec2 size) {
  const auto view = session_.camera();
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  if (!view || view->width == 0) {
    ImGui::Dummy(size);
    ImGui::GetWindowDrawList()->AddText(nullptr, 0, {origin.x + ui.px(0.6F), origin.y + ui.px(0.5F)},
                                        packed(ui.colours.faint), ui.text(Text::kNoPicture), nullptr,
                                        size.x - ui.px(1.2F));
    return;
  }
  ui.facts.insert("camera-picture");
  if (view != shown_) {
    texture_.upload(view->width, view->height, 3, hatched(*view).data(), false);
    shown_ = view;
  }
  // The picture has what the words below it leave, however many lines they take.
  const std::string exposure = exposure_line(view->exposure, ui.preferences.language);
  const auto high = [&](const ImFont* font, const char* words) {
    return font->CalcTextSizeA(font->FontSize, 1e6F, size.x, words).y + ImGui::GetStyle().ItemSpacing.y;
  };
  const float words_high =
      high(ImGui::GetFont(), exposure.c_str()) + high(ui.fonts.small, ui.text(Text::kHatchLegend));
  const float room = std::max(size.y - words_high, 0.3F * size.y);
  const float scale =
      std::min(size.x / static_cast<float>(view->width), room / static_cast<float>(view->height));
  const ImVec2 drawn{scale * static_cast<float>(view->width), scale * static_cast<float>(view->height)};
  ImGui::Dummy(drawn);
  ui.target("camera-view");
  ImGui::GetWindowDrawList()->AddImage(picture_of(texture_.id()), origin,
                                       {origin.x + drawn.x, origin.y + drawn.y});
  constexpr const char* kAdvice[] = {"exposure-good", "exposure-too-long", "exposure-too-short"};
  ui.facts.insert(kAdvice[static_cast<int>(view->exposure.advice)]);
  const bool good = view->exposure.advice == ExposureAdvice::kGood;
  coloured_text(good ? ui.colours.good : ui.colours.amber, exposure.c_str());
  ImGui::PushFont(ui.fonts.small);
  coloured_text(ui.colours.faint, ui.text(Text::kHatchLegend));
  ImGui::PopFont();
}

void CameraDialog::draw_settings(UiContext& ui, const DevicePanel& panel) {
  for (const DevicePanel::Setting& setting : panel.settings) {
    std::string& typed = typed_[setting.info.key];
    const std::string name = fmt::format("setting.{}", setting.info.key);
    if (!setting.info.writable) {
      coloured_text(ui.colours.faint,
                    fmt::format("{}: {} {}", setting.info.key, setting.word, setting.info.unit).c_str());
      continue;
    }
    const bool changed = setting_widget(ui, name, setting.info, typed);
    const bool at_once = is_put_at_once(setting.info);
    bool put = changed && at_once;
    if (!at_once) {
      put = plain_button(ui, fmt::format("put.{}", setting.info.key).c_str(), ui.text(Text::kPutSetting),
                         typed != setting.word);
    }
    if (put) {
      put_.insert(setting.info.key);
      const bool off = setting.info.type == SettingType::kBool && typed.empty();
      session_.change_setting(setting.info.key, off ? "0" : driver_word(setting.info, typed));
    }
    ui.facts.insert(fmt::format("{}={}", name, setting.word));
  }
  if (panel.settings.empty()) {
    coloured_text(ui.colours.faint, ui.text(Text::kNoSettings));
  }
}

/// The device tells its settings anew whenever one is put. What is typed of another, and not put yet, stays.
void CameraDialog::take_panel(std::shared_ptr<const DevicePanel> panel) {
  const std::map<std::string, std::string> typed = std::exchange(typed_, {});
  const std::set<std::string> put = std::exchange(put_, {});
  const auto before = std::exchange(panel_, std::move(panel));
  const bool is_same = before && panel_ && before->uri == panel_->uri;
  for (std::size_t k = 0; panel_ && k < panel_->settings.size(); ++k) {
    const DevicePanel::Setting& setting = panel_->settings[k];
    const std::string& key = setting.info.key;
    const bool off = setting.info.type == SettingType::kBool && setting.word == "false";
    typed_[key] = off ? std::string() : setting.word;
    if (!is_same || is_put_at_once(setting.info) || put.contains(key)) {
      continue;
    }
    const auto known = std::ranges::find_if(
        before->settings, [&](const DevicePanel::Setting& one) { return one.info.key == key; });
    const auto word = typed.find(key);
    if (known != before->settings.end() && word != typed.end() && word->second != known->word) {
      typed_[key] = word->second;
    }
  }
}

void CameraDialog::draw(UiContext& ui, const LiveState& state) {
  if (opening_) {
    old_notice_ = state.notice;
    panel_.reset();  // what was typed then and never put is not what is set
  } else if (state.notice != old_notice_) {
    old_notice_.clear();
  }
  open_ = open_ || opening_;
  if (!begin_wide_box(ui, ui.text(Text::kCamera), kPopup, opening_)) {
    if (std::exchange(open_, false)) {
      session_.watch_camera(false);
      shown_.reset();
    }
    return;
  }
  session_.watch_camera(true);
  if (state.panel != panel_) {
    take_panel(state.panel);
  }
  const float foot = ImGui::GetFrameHeightWithSpacing() + 2 * ImGui::GetTextLineHeightWithSpacing();
  const float right = std::min(ui.px(20), 0.36F * ImGui::GetIO().DisplaySize.x);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const ImVec2 left{room.x - right - ImGui::GetStyle().ItemSpacing.x, room.y - foot};
  ImGui::BeginChild("view", left, true, ImGuiWindowFlags_NoScrollbar);
  draw_view(ui, ImGui::GetContentRegionAvail());
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("settings", {right, left.y}, true);
  if (panel_) {
    draw_settings(ui, *panel_);
  }
  ImGui::EndChild();
  ImGui::PushFont(ui.fonts.small);
  coloured_text(ui.colours.faint, state.notice.empty() || state.notice == old_notice_
                                      ? ui.text(Text::kSettingsKept)
                                      : translated(state.notice, ui.preferences.language).c_str());
  ImGui::PopFont();
  if (plain_button(ui, "close-camera", ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace dubsar::ui
