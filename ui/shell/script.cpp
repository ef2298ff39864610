// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/script.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "ui/shell/typed_signs.h"

namespace dubsar::ui {

namespace {

constexpr double kPatienceS = 60;
constexpr int kQuietFrames = 4;
constexpr float kDoubleClickS = 0.3F;  ///< between two clicks at most, as ImGui has it
constexpr float kAnyTimeS = 60;

const std::map<std::string, int>& keys() {
  static const std::map<std::string, int> kKeys{{"space", GLFW_KEY_SPACE},
                                                {"enter", GLFW_KEY_ENTER},
                                                {"backspace", GLFW_KEY_BACKSPACE},
                                                {"escape", GLFW_KEY_ESCAPE},
                                                {"tab", GLFW_KEY_TAB},
                                                {"backtab", GLFW_KEY_TAB},
                                                {"up", GLFW_KEY_UP},
                                                {"down", GLFW_KEY_DOWN},
                                                {"left", GLFW_KEY_LEFT},
                                                {"right", GLFW_KEY_RIGHT},
                                                {"f9", GLFW_KEY_F9},
                                                {"f10", GLFW_KEY_F10},
                                                {"f11", GLFW_KEY_F11},
                                                {"f12", GLFW_KEY_F12},
                                                {"l", GLFW_KEY_L},
                                                {"n", GLFW_KEY_N},
                                                {"p", GLFW_KEY_P},
                                                {"pagedown", GLFW_KEY_PAGE_DOWN},
                                                {"pageup", GLFW_KEY_PAGE_UP},
                                                {"end", GLFW_KEY_END},
                                                {"1", GLFW_KEY_1},
                                                {"2", GLFW_KEY_2},
                                                {"3", GLFW_KEY_3},
                                                {"4", GLFW_KEY_4},
                                                {"5", GLFW_KEY_5},
                                                {"6", GLFW_KEY_6},
                                                {"selectall", GLFW_KEY_A}};
  return kKeys;
}

const std::map<std::string, ScriptStep::Kind>& kinds() {
  using Kind = ScriptStep::Kind;
  static const std::map<std::string, Kind> kKinds{
      {"key", Kind::kKey},     {"click", Kind::kClick},   {"doubleclick", Kind::kDoubleClick},
      {"drag", Kind::kDrag},   {"wheel", Kind::kWheel},   {"type", Kind::kType},
      {"wait", Kind::kWait},   {"expect", Kind::kExpect}, {"screenshot", Kind::kScreenshot},
      {"pause", Kind::kPause}, {"resize", Kind::kResize}, {"quit", Kind::kQuit},
      {"halt", Kind::kKey}};
  return kKinds;
}

std::optional<double> number_of(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

std::string rest_of(std::istringstream& words) {
  std::string rest;
  std::getline(words >> std::ws, rest);
  return rest;
}

}  // namespace

Result<std::vector<ScriptStep>> parse_script(std::string_view text, const std::string& where) {
  std::vector<ScriptStep> steps;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string verb;
    if (!(words >> verb) || verb.front() == '#') {
      continue;
    }
    const std::string place = where + ":" + std::to_string(number);
    const auto kind = kinds().find(verb);
    if (kind == kinds().end()) {
      return fail(ErrorKind::kUsage, "there is no step '" + verb + "'", place,
                  "it is key, click, doubleclick, drag, wheel, type, wait, expect, screenshot, pause, "
                  "resize, halt or quit");
    }
    ScriptStep step;
    step.kind = kind->second;
    step.line = number;
    using Kind = ScriptStep::Kind;
    const bool is_click = step.kind == Kind::kClick || step.kind == Kind::kDoubleClick;
    std::size_t wants = 0;  // numbers
    if (verb == "halt") {
      step.name = "f12";
    } else if (step.kind == Kind::kType || step.kind == Kind::kScreenshot) {
      step.name = rest_of(words);
    } else {
      if (step.kind == Kind::kResize) {
        step.name = verb;
      } else if (step.kind != Kind::kPause && step.kind != Kind::kQuit) {
        words >> step.name;
      }
      std::string word;
      while (words >> word) {
        const auto value = number_of(word);
        const bool named = step.kind == Kind::kWait || step.kind == Kind::kExpect || is_click;
        if (!value && named && word != "right" && step.numbers.empty()) {
          step.name += ' ' + word;  // of several words
          continue;
        }
        if (!value && word != "right") {
          return fail(ErrorKind::kUsage, "'" + word + "' is no number", place, "numbers follow the name");
        }
        if (value) {
          step.numbers.push_back(*value);
        } else {
          step.right = true;
        }
      }
      wants = step.kind == Kind::kDrag                                 ? 4
              : step.kind == Kind::kResize                             ? 2
              : step.kind == Kind::kWheel || step.kind == Kind::kPause ? 1
                                                                       : 0;
    }
    const bool nameless = step.name.empty() && step.kind != Kind::kPause && step.kind != Kind::kQuit;
    const bool odd_click = is_click && step.numbers.size() != 0 && step.numbers.size() != 2;
    if (nameless || step.numbers.size() < wants || odd_click) {
      return fail(ErrorKind::kUsage, "step '" + verb + "' says too little", place,
                  "see docs/operators/window_scripts.md");
    }
    if (step.kind == Kind::kKey && !keys().contains(step.name)) {
      return fail(ErrorKind::kUsage, "there is no key '" + step.name + "'", place,
                  "see docs/operators/window_scripts.md");
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

ScriptPlayer::ScriptPlayer(std::vector<ScriptStep> steps, std::string where)
    : steps_(std::move(steps)), where_(std::move(where)) {}

void ScriptPlayer::fail_step(const std::string& what) {
  failure_ = Error{ErrorKind::kUsage, what, where_ + ":" + std::to_string(steps_[next_].line), {}};
}

std::string ScriptPlayer::place() const {
  return finished() ? std::string() : "line " + std::to_string(steps_[next_].line);
}

void ScriptPlayer::go_on() {
  ++next_;
  frame_ = 0;
  began_s_ = -1;
  quiet_frames_ = 0;
}

bool ScriptPlayer::place_of(const UiContext& ui, std::size_t first_number, ImVec2& out) const {
  const ScriptStep& step = steps_[next_];
  const auto target = ui.targets.find(step.name);
  if (target == ui.targets.end()) {
    return false;
  }
  const auto part = [&](std::size_t k) {
    return first_number + k < step.numbers.size() ? static_cast<float>(step.numbers[first_number + k]) : 0.5F;
  };
  const ImVec4& r = target->second;
  out = {r.x + part(0) * (r.z - r.x), r.y + part(1) * (r.w - r.y)};
  return true;
}

void ScriptPlayer::inject(const UiContext& ui, double now_s) {
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = pointer_;
  if (finished()) {
    return;
  }
  const ScriptStep& step = steps_[next_];
  if (began_s_ < 0) {
    began_s_ = now_s;
  }
  using Kind = ScriptStep::Kind;
  const double patience = step.kind == Kind::kWait && !step.numbers.empty() ? step.numbers[0] : kPatienceS;
  if (step.kind != Kind::kPause && now_s - began_s_ > patience) {
    fail_step("waited in vain for '" + step.name + "'");
    return;
  }
  const int button = step.right ? 1 : 0;
  switch (step.kind) {
    case Kind::kKey: {
      const auto key = static_cast<std::size_t>(keys().at(step.name));
      io.KeysDown[key] = frame_ < 2;
      io.KeyCtrl = step.name == "selectall" && frame_ < 2;
      io.KeyShift = step.name == "backtab" && frame_ < 2;
      if (++frame_ > 4) {
        go_on();
      }
      return;
    }
    case Kind::kClick: {
      if (frame_ == 0 && !place_of(ui, 0, pointer_)) {
        return;
      }
      io.MousePos = pointer_;
      io.MouseDown[button] = frame_ == 2 || frame_ == 3;
      if (++frame_ > 6) {
        go_on();
      }
      return;
    }
    case Kind::kDoubleClick: {
      if (frame_ == 0 && !place_of(ui, 0, pointer_)) {
        return;
      }
      io.MousePos = pointer_;
      io.MouseDown[button] = frame_ == 2 || frame_ == 3 || frame_ == 5 || frame_ == 6;
      // Hands are as fast on any machine; frames are not.
      io.MouseDoubleClickTime = frame_ >= 5 && frame_ <= 6 ? kAnyTimeS : kDoubleClickS;
      if (++frame_ > 9) {
        go_on();
      }
      return;
    }
    case Kind::kDrag: {
      constexpr int kFrames = 10;
      ImVec2 from;
      ImVec2 to;
      if (!place_of(ui, 0, from) || !place_of(ui, 2, to)) {
        return;
      }
      const float part = std::min(1.0F, std::max(0.0F, static_cast<float>(frame_ - 2) / kFrames));
      pointer_ = {from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)};
      io.MousePos = pointer_;
      io.MouseDown[button] = frame_ >= 2 && frame_ < kFrames + 4;
      if (++frame_ > kFrames + 6) {
        go_on();
      }
      return;
    }
    case Kind::kWheel:
      if (frame_ == 0 && !place_of(ui, 1, pointer_)) {
        return;
      }
      io.MousePos = pointer_;
      io.MouseWheel = frame_ == 2 ? static_cast<float>(step.numbers[0]) : 0.0F;
      if (++frame_ > 4) {
        go_on();
      }
      return;
    case Kind::kType:
      if (frame_++ == 0) {
        io.AddInputCharactersUTF8(stand_ins_of(step.name).c_str());
      } else {
        go_on();
      }
      return;
    case Kind::kWait:
      if (ui.facts.contains(step.name) || ui.targets.contains(step.name)) {
        go_on();
      }
      return;
    case Kind::kExpect:
      if (++frame_ > 2) {
        if (ui.facts.contains(step.name) || ui.targets.contains(step.name)) {
          go_on();
        } else {
          fail_step("'" + step.name + "' is not the case");
        }
      }
      return;
    case Kind::kPause:
      if (now_s - began_s_ >= step.numbers[0]) {
        go_on();
      }
      return;
    case Kind::kResize: {
      const int width = std::max(1, static_cast<int>(step.numbers[0]));
      const int height = std::max(1, static_cast<int>(step.numbers[1]));
      if (frame_++ == 0) {
        glfwSetWindowSize(glfwGetCurrentContext(), width, height);
      } else if (std::lround(io.DisplaySize.x) == width && std::lround(io.DisplaySize.y) == height) {
        go_on();
      }
      return;
    }
    case Kind::kQuit:
      next_ = steps_.size();
      return;
    case Kind::kScreenshot:
      return;
  }
}

std::optional<std::filesystem::path> ScriptPlayer::screenshot_due(bool quiet) {
  if (finished() || steps_[next_].kind != ScriptStep::Kind::kScreenshot) {
    return std::nullopt;
  }
  quiet_frames_ = quiet ? quiet_frames_ + 1 : 0;
  if (quiet_frames_ < kQuietFrames) {
    return std::nullopt;
  }
  std::filesystem::path file = steps_[next_].name;
  go_on();
  return file;
}

}  // namespace dubsar::ui
