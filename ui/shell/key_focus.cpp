// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/key_focus.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <initializer_list>
#include <ranges>

namespace dubsar::ui {

namespace {

constexpr int kMostArrivingFrames = 5;  ///< until what is scrolled to is in sight

/// A key that is held does so once: where frames are slow a tap would count as two.
bool any_goes_down(std::initializer_list<int> keys) {
  return std::ranges::any_of(keys, [](int key) { return ImGui::IsKeyPressed(key, false); });
}

/// What is open over all else, and shuts by a click beside it; 0: none.
ImGuiID open_list() {
  const ImGuiContext& g = *ImGui::GetCurrentContext();
  if (g.OpenPopupStack.empty()) {
    return 0;
  }
  const ImGuiPopupData& top = g.OpenPopupStack.back();
  const bool is_box = top.Window == nullptr || (top.Window->Flags & ImGuiWindowFlags_Modal) != 0;
  return is_box ? 0 : top.PopupId;
}

}  // namespace

void KeyFocus::follow_boxes() {
  const ImGuiContext& g = *ImGui::GetCurrentContext();
  std::size_t same = 1;
  for (const ImGuiPopupData& popup : g.OpenPopupStack) {
    if (same >= levels_.size() || levels_[same].popup != popup.PopupId) {
      break;
    }
    ++same;
  }
  levels_.resize(same);
  for (int k = static_cast<int>(same) - 1; k < g.OpenPopupStack.Size; ++k) {
    levels_.push_back({g.OpenPopupStack[k].PopupId, 0, levels_.back().shown});
  }
}

std::vector<KeyFocus::Stop> KeyFocus::stops_here() const {
  std::vector<Stop> out;
  std::ranges::copy_if(stops_, std::back_inserter(out),
                       [&](const Stop& stop) { return stop.popup == levels_.back().popup; });
  return out;
}

void KeyFocus::arrive(Id item) {
  levels_.back().item = item;
  arriving_ = item;
  arriving_frames_ = 0;
  if (ImGui::GetActiveID() != item) {
    ImGui::ClearActiveID();  // a line that was typed into is left, and what was typed is kept
  }
}

/// From where one is, round and round.
void KeyFocus::go(int by) {
  const std::vector<Stop> stops = stops_here();
  if (stops.empty()) {
    return;
  }
  Level& here = levels_.back();
  here.shown = true;
  const auto count = static_cast<int>(stops.size());
  const auto at = static_cast<int>(std::ranges::find(stops, here.item, &Stop::item) - stops.begin());
  const int next = at < count ? at + by : by > 0 ? 0 : count - 1;
  arrive(stops[static_cast<std::size_t>((next + count) % count)].item);
}

void KeyFocus::begin(bool space_scans) {
  follow_boxes();
  const bool in_box = levels_.size() > 1;
  list_ = open_list();
  const ImGuiContext& g = *ImGui::GetCurrentContext();
  Level& here = levels_.back();
  const std::vector<Stop> stops = stops_here();
  const auto stop_of = [&](Id item) { return std::ranges::find(stops, item, &Stop::item); };
  if (std::ranges::any_of(g.IO.MouseClicked, [](bool clicked) { return clicked; })) {
    here.shown = false;
  }
  if (stop_of(g.ActiveId) != stops.end()) {  // that was clicked
    here.item = g.ActiveId;
  }
  const bool is_new = here.item == 0 && !stops.empty();
  if (is_new && stop_of(g.NavActivateInputId) != stops.end()) {  // a line that asks for the cursor itself
    here.item = g.NavActivateInputId;
  } else if (is_new && here.shown) {
    arrive(stops.front().item);
  }
  if (!stops.empty() && stop_of(here.item) == stops.end()) {
    here.shown = false;  // it is gone, or cannot be pressed any more
  }
  const bool own_key = space_scans && !g.IO.WantTextInput &&
                       any_goes_down({GLFW_KEY_SPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_F9, GLFW_KEY_F10,
                                      GLFW_KEY_F11, GLFW_KEY_PAGE_DOWN, GLFW_KEY_PAGE_UP, GLFW_KEY_END});
  if (!in_box && (own_key || any_goes_down({GLFW_KEY_ESCAPE}))) {
    here.shown = false;
  }
  const bool arrows = here.shown || in_box;
  if (any_goes_down({GLFW_KEY_TAB}) && !g.IO.KeyCtrl && !g.IO.KeyAlt) {
    go(g.IO.KeyShift ? -1 : 1);
  } else if (arrows && any_goes_down({GLFW_KEY_DOWN})) {
    go(1);
  } else if (arrows && any_goes_down({GLFW_KEY_UP})) {
    go(-1);
  }
  const auto at = stop_of(here.item);
  takes_enter_ = here.shown && at != stops.end() && at->reach == Reach::kPressed;
  if (takes_enter_ && (any_goes_down({GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER}) ||
                       ((in_box || !space_scans) && any_goes_down({GLFW_KEY_SPACE})))) {
    ImGui::ActivateItem(here.item);
  }
  stops_.clear();
}

bool KeyFocus::item(Reach reach) {
  ImGuiContext& g = *ImGui::GetCurrentContext();
  const ImGuiLastItemData& last = g.LastItemData;
  if (reach == Reach::kNone || last.ID == 0 || (last.InFlags & ImGuiItemFlags_Disabled) != 0) {
    return false;
  }
  const ImGuiWindow* root = g.CurrentWindow->RootWindow;
  const Id popup = (root->Flags & ImGuiWindowFlags_Popup) != 0 ? root->PopupId : 0;
  stops_.push_back({popup, last.ID, reach});
  if (last.ID == arriving_) {
    const bool in_sight = ImGui::IsItemVisible();
    if (in_sight && reach == Reach::kTyped && g.ActiveId != last.ID) {
      g.NavNextActivateId = last.ID;
      g.NavNextActivateFlags = ImGuiActivateFlags_PreferInput;
    }
    ImGui::ScrollToItem();
    arriving_ = in_sight || ++arriving_frames_ > kMostArrivingFrames ? 0 : arriving_;
  }
  const Level& here = levels_.back();
  return here.shown && here.item == last.ID && here.popup == popup;
}

void KeyFocus::end() const {
  if (list_ != 0 && list_ == open_list() && any_goes_down({GLFW_KEY_ESCAPE})) {
    ImGui::ClosePopupToLevel(ImGui::GetCurrentContext()->OpenPopupStack.Size - 1, true);
  }
}

bool KeyFocus::takes_enter() const {
  return takes_enter_;
}

}  // namespace dubsar::ui
