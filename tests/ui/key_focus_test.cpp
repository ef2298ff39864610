// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/key_focus.h"

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <array>
#include <string>
#include <vector>

namespace dubsar::ui {
namespace {

/// A screen of two buttons, one that cannot be pressed, and a line to type in; "box" opens a box with a list
/// that drops down.
class KeyFocusTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {800, 600};
    io.DeltaTime = 1.0F / 60;
    io.KeyMap[ImGuiKey_Escape] = GLFW_KEY_ESCAPE;
    io.KeyMap[ImGuiKey_Enter] = GLFW_KEY_ENTER;
    io.Fonts->Build();
    frame();
    frame();
  }
  void TearDown() override { ImGui::DestroyContext(); }

  void button(const char* name, bool enabled = true) {
    ImGui::BeginDisabled(!enabled);
    if (ImGui::Button(name)) {
      pressed_.emplace_back(name);
    }
    ImGui::EndDisabled();
    at(name, Reach::kPressed);
  }
  void at(const char* name, Reach reach) { framed_ = keys_.item(reach) ? name : framed_; }

  void frame() {
    ImGui::NewFrame();
    keys_.begin(space_scans_);
    framed_ = std::string("-");
    ImGui::SetNextWindowSize({400, 400});
    ImGui::Begin("screen");
    button("scan", may_scan_);
    button("undo");
    button("sign", false);
    ImGui::InputText("line", line_.data(), line_.size());
    at("line", Reach::kTyped);
    ImGui::Button("picture");
    at("picture", Reach::kNone);
    button("box");
    if (!pressed_.empty() && pressed_.back() == "box") {
      pressed_.pop_back();
      ImGui::OpenPopup("a box");
    }
    if (ImGui::BeginPopupModal("a box")) {
      if (ImGui::BeginCombo("list", "")) {
        pressed_choice("first");
        pressed_choice("second");
        ImGui::EndCombo();
      }
      at("list", Reach::kPressed);
      button("use");
      if (!pressed_.empty() && pressed_.back() == "use") {
        ImGui::CloseCurrentPopup();
      }
      ImGui::EndPopup();
    }
    ImGui::End();
    takes_enter_ = keys_.takes_enter();
    keys_.end();
    ImGui::Render();
  }
  void pressed_choice(const char* name) {
    if (ImGui::Selectable(name)) {
      pressed_.emplace_back(name);
    }
    at(name, Reach::kPressed);
  }
  /// As a hand would: two frames down, and until all has settled. Where the frame is then.
  std::string press(int key, bool shift = false) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyShift = shift;
    io.KeysDown[key] = true;
    frame();
    const bool took_enter = takes_enter_;
    frame();
    io.KeysDown[key] = io.KeyShift = false;
    for (int k = 0; k < 4; ++k) {
      frame();
    }
    took_enter_ = took_enter;
    return framed_;
  }
  std::string tab() { return press(GLFW_KEY_TAB); }
  std::string back() { return press(GLFW_KEY_TAB, true); }
  void type(const char* text) {
    ImGui::GetIO().AddInputCharactersUTF8(text);
    frame();
    frame();
  }

  KeyFocus keys_;
  bool space_scans_ = true, may_scan_ = true;
  std::array<char, 20> line_{};
  std::vector<std::string> pressed_;
  std::string framed_;
  bool takes_enter_ = false, took_enter_ = false;
};

using Names = std::vector<std::string>;

TEST_F(KeyFocusTest, TabGoesRoundWhatCanBePressedInTheOrderOfTheScreen) {
  EXPECT_EQ(framed_, "-");
  for (const char* next : {"scan", "undo", "line", "box", "scan"}) {
    EXPECT_EQ(tab(), next);
  }
  for (const char* next : {"box", "line", "undo"}) {
    EXPECT_EQ(back(), next);
  }
  EXPECT_EQ(press(GLFW_KEY_DOWN), "line");
  EXPECT_EQ(press(GLFW_KEY_UP), "undo");
  EXPECT_EQ(pressed_, Names());
}

TEST_F(KeyFocusTest, ATapIsOneWhereFramesAreSlow) {
  ImGui::GetIO().DeltaTime = 1;
  EXPECT_EQ(tab(), "scan");
  EXPECT_EQ(press(GLFW_KEY_DOWN), "undo");
  EXPECT_EQ(press(GLFW_KEY_UP), "scan");
}

TEST_F(KeyFocusTest, NothingIsFramedBeforeATab) {
  EXPECT_EQ(press(GLFW_KEY_DOWN), "-");
  EXPECT_EQ(press(GLFW_KEY_ENTER), "-");
  EXPECT_FALSE(took_enter_);
  EXPECT_EQ(back(), "box") << "backwards from the end";
}

TEST_F(KeyFocusTest, EnterPressesWhatIsFramedAndIsForNothingElse) {
  tab();
  EXPECT_EQ(press(GLFW_KEY_ENTER), "scan");
  EXPECT_TRUE(took_enter_);
  EXPECT_EQ(pressed_, Names{"scan"});
  tab();
  press(GLFW_KEY_KP_ENTER);
  EXPECT_EQ(pressed_, (Names{"scan", "undo"}));
}

TEST_F(KeyFocusTest, TheStationsOwnKeysStayItsOwnAndTakeTheFrameAway) {
  for (const int key : {GLFW_KEY_SPACE, GLFW_KEY_F9, GLFW_KEY_PAGE_DOWN, GLFW_KEY_BACKSPACE, GLFW_KEY_F10,
                        GLFW_KEY_PAGE_UP, GLFW_KEY_F11, GLFW_KEY_END, GLFW_KEY_ESCAPE}) {
    if (tab() == "line") {  // where they type, and go to its end
      tab();
    }
    EXPECT_EQ(press(key), "-") << key;
    press(GLFW_KEY_ENTER);
    EXPECT_FALSE(took_enter_) << "enter finishes again";
  }
  EXPECT_EQ(pressed_, Names());
  // Where nothing is scanned, space presses what is framed.
  space_scans_ = false;
  tab();
  const std::string framed = framed_;
  press(GLFW_KEY_SPACE);
  EXPECT_EQ(pressed_, Names{framed});
}

TEST_F(KeyFocusTest, ALineIsTypedIntoAsSoonAsItIsReachedAndKeepsWhatWasTyped) {
  tab();
  tab();
  EXPECT_EQ(tab(), "line");
  type("BM 15285");
  press(GLFW_KEY_SPACE);
  EXPECT_EQ(press(GLFW_KEY_ENTER), "line");
  EXPECT_FALSE(took_enter_) << "it is for the box that the line stands in";
  tab();
  EXPECT_STREQ(line_.data(), "BM 15285");
  EXPECT_FALSE(ImGui::IsAnyItemActive());
}

TEST_F(KeyFocusTest, WhatCannotBePressedAnyMoreIsNotFramed) {
  tab();
  may_scan_ = false;
  frame();
  frame();
  EXPECT_EQ(framed_, "-");
  press(GLFW_KEY_ENTER);
  EXPECT_FALSE(took_enter_);
  may_scan_ = true;
  frame();
  EXPECT_EQ(framed_, "-") << "it does not come back by itself";
  may_scan_ = false;
  frame();
  EXPECT_EQ(tab(), "undo");
}

TEST_F(KeyFocusTest, AClickTakesTheFrameAwayAndTabGoesOnFromThere) {
  tab();
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = {790, 590};
  io.MouseDown[0] = true;
  frame();
  io.MouseDown[0] = false;
  frame();
  EXPECT_EQ(framed_, "-");
  EXPECT_EQ(tab(), "undo");
}

TEST_F(KeyFocusTest, ABoxThatIsOpenHasTheKeysAndOneComesBackToWhereOneWas) {
  back();
  EXPECT_EQ(press(GLFW_KEY_ENTER), "list") << "the first in the box";
  EXPECT_EQ(tab(), "use");
  EXPECT_EQ(tab(), "list") << "nothing behind the box";
  EXPECT_EQ(press(GLFW_KEY_SPACE), "first") << "the list has dropped down";
  EXPECT_EQ(press(GLFW_KEY_ESCAPE), "list") << "escape shuts the list alone";
  press(GLFW_KEY_SPACE);
  EXPECT_EQ(press(GLFW_KEY_DOWN), "second");
  EXPECT_EQ(press(GLFW_KEY_ENTER), "list");
  EXPECT_EQ(pressed_, Names{"second"});
}

/// Else the next enter would press something that nobody chose.
TEST_F(KeyFocusTest, AFrameThatBeganInABoxEndsWithIt) {
  pressed_.emplace_back("box");  // as by a key of the station
  frame();
  frame();
  EXPECT_EQ(framed_, "-");
  EXPECT_EQ(tab(), "list");
  EXPECT_EQ(tab(), "use");
  EXPECT_EQ(press(GLFW_KEY_ENTER), "-");
  EXPECT_EQ(pressed_, Names{"use"});
  press(GLFW_KEY_ENTER);
  EXPECT_FALSE(took_enter_);
}

}  // namespace
}  // namespace dubsar::ui
