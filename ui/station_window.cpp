// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/station_window.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "core/log.h"
#include "core/yielding_loops.h"
#include "station/device_patience.h"
#include "station/picture_file.h"
#include "ui/gl/frame_target.h"
#include "ui/gl/gl_window.h"
#include "ui/operator/operator_screen.h"
#include "ui/shell/key_taps.h"
#include "ui/shell/script.h"
#include "ui/shell/typed_signs.h"
#include "ui/viewer/pair_screen.h"
#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

constexpr double kIdleS = 0.5;     ///< between two looks when nothing happens
constexpr double kMotionS = 0.06;  ///< between two frames of something that moves by itself
/// While a picture is filled in there is only a look at what the user does.
constexpr double kAtOnceS = 0.001;
constexpr double kScriptWaitS = 0.1;
/// ImGui needs some frames to settle after an event.
constexpr int kFramesAfterEvent = 4;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Signs that ImGui cannot hold come and go by their stand-ins (ui/shell/typed_signs.h).
void type_by_stand_ins(GLFWwindow* window) {
  glfwSetCharCallback(
      window, [](GLFWwindow* of, unsigned int sign) { ImGui_ImplGlfw_CharCallback(of, stand_in_of(sign)); });
  ImGuiIO& io = ImGui::GetIO();
  io.GetClipboardTextFn = [](void* of) -> const char* {
    static std::string pasted;
    const char* text = glfwGetClipboardString(static_cast<GLFWwindow*>(of));
    pasted = stand_ins_of(text == nullptr ? "" : text);
    return pasted.c_str();
  };
  io.SetClipboardTextFn = [](void* of, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(of), signs_of(text).c_str());
  };
  io.ClipboardUserData = window;
}

/// ImGui and its back ends for a window; ends them when it goes.
class GuiScope {
 public:
  explicit GuiScope(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // nothing of the layout is the user's to lose
    glfwSetWindowUserPointer(window, &taps_);
    glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int /*code*/, int action, int /*modifiers*/) {
      if (action != GLFW_REPEAT) {
        static_cast<KeyTaps*>(glfwGetWindowUserPointer(of))->happened(key, action == GLFW_PRESS);
      }
    });
    ImGui_ImplGlfw_InitForOpenGL(window, true);  // its own callback calls that one
    type_by_stand_ins(window);
    ImGui::GetIO().KeyMap[ImGuiKey_Tab] = -1;  // KeyFocus goes by it, not only to lines that are typed into
    ImGui_ImplOpenGL3_Init("#version 410 core");
  }
  ~GuiScope() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  GuiScope(const GuiScope&) = delete;
  GuiScope& operator=(const GuiScope&) = delete;

  void new_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    taps_.put_into(io.KeysDown);
    const auto either = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
    io.KeyCtrl = either(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    io.KeyShift = either(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    io.KeyAlt = either(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
    io.KeySuper = either(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER);
  }

 private:
  KeyTaps taps_;
};

Result<std::optional<ScriptPlayer>> load_script(const std::filesystem::path& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {  // it opens, and reading it throws
    return fail(ErrorKind::kBadInput, "not a file", file.string(), "name a file");
  }
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) {
    return fail(ErrorKind::kBadInput, "the script cannot be read", file.string());
  }
  auto steps = parse_script(text, file.string());
  if (!steps) {
    return std::unexpected(steps.error());
  }
  return ScriptPlayer(std::move(*steps), file.string());
}

/// One run of the window.
class StationWindow {
 public:
  StationWindow(GlWindow window, const StationWindowOptions& options, std::optional<ScriptPlayer> script,
                double opened_s)
      : window_(std::move(window)), gui_(window_.handle()), script_(std::move(script)), opened_s_(opened_s) {
    preferences_file_ = script_ ? std::filesystem::path() : preferences_file();
    ui_.preferences = read_preferences(preferences_file_,
                                       script_ ? Preferences() : usual_preferences(window_.content_scale()));
    if (const auto language = language_of(options.language)) {
      ui_.preferences.language = *language;
    }
    ui_.still = script_.has_value();
    kept_ = ui_.preferences;
    pins_ = options.pins;
    given_up_ = options.given_up;
    looks_ = !options.mesh.empty();
    viewing_ = std::make_unique<MeshViewing>(wake_window);
    if (looks_) {
      viewing_->open(options.mesh);
      if (!options.other_mesh.empty()) {
        other_viewing_ = std::make_unique<MeshViewing>(wake_window);
        other_viewing_->open(options.other_mesh);
        pair_ = std::make_unique<PairScreen>(*viewing_, *other_viewing_);
        return;
      }
      viewer_ = std::make_unique<ViewerScreen>(*viewing_, std::filesystem::path("."), false);
      return;
    }
    const bool is_asked = !options.device.empty();
    open_session({is_asked ? options.device : ui_.preferences.device, options.session, options.pins, is_asked,
                  given_up_});
  }

  /// A driver that is still looked for devices keeps the screens: it too is waited for so long and no longer.
  ~StationWindow() {
    std::optional<DevicePatience> patience;
    if (given_up_) {
      patience.emplace([] { return true; }, nullptr, given_up_);
    }
    viewer_.reset();
    operator_.reset();
    session_.reset();
  }
  StationWindow(const StationWindow&) = delete;
  StationWindow& operator=(const StationWindow&) = delete;

  Result<int> run(const JobContext& job) {
    int settle = kFramesAfterEvent;
    bool moving = false;
    while (glfwWindowShouldClose(window_.handle()) == GLFW_FALSE && !job.cancelled()) {
      if (script_) {
        glfwWaitEventsTimeout(script_->waits() && !draws_on_ ? kScriptWaitS : kAtOnceS);
      } else {
        const double began = now_s();
        const double patience = settle > 0 || draws_on_ ? kAtOnceS : moving ? kMotionS : kIdleS;
        glfwWaitEventsTimeout(patience);
        if (now_s() - began < 0.9 * patience) {
          settle = kFramesAfterEvent;
        } else {
          settle = std::max(0, settle - 1);
        }
      }
      ui_.watch.begin(FrameWatch::Clock::now(), script_ ? script_->place() : std::string());
      moving = draw_frame();
      if (Status taken = take_screenshot(moving); !taken) {
        return std::unexpected(taken.error());
      }
      glfwSwapBuffers(window_.handle());
      if (script_) {
        glFinish();  // a driver that queues would not have shown the picture yet
      }
      ui_.watch.end(FrameWatch::Clock::now());
      if (const auto since = operator_ && !looks_ ? operator_->profiles_since() : std::nullopt) {
        glFinish();
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - *since;
        profile_waits_s_.push_back(waited.count());
      }
      if (!seen_ && ui_.facts.contains("shown")) {
        seen_ = true;
        log_debug(fmt::format("first picture of the mesh: {:.2f} s", now_s() - opened_s_));
      }
      keep_preferences();
      if (const auto unreadable = mesh_error()) {
        return std::unexpected(*unreadable);
      }
      if (script_ && script_->finished()) {
        tell_profile_waits();
        for (const std::string& line : ui_.watch.lines()) {
          log_info(line);
        }
        if (script_->failure()) {
          log_error(script_->failure()->line());
          return 1;
        }
        return 0;
      }
    }
    return 0;
  }

 private:
  void open_session(const LiveSession::Options& options) {
    operator_.reset();
    viewing_->stop();  // what is still worked out there is of the tablet before
    session_ = std::make_unique<LiveSession>(options, wake_window);
    session_->read();
    operator_ = std::make_unique<OperatorScreen>(*session_);
    viewer_ = std::make_unique<ViewerScreen>(*viewing_, options.session / "export", true);
  }

  /// Between two frames: what the last one drew is still wanted until it is shown.
  void go_to_next_session() {
    const auto folder = operator_ ? operator_->wants_session() : std::nullopt;
    if (!folder) {
      return;
    }
    std::optional<PinSet> pins = pins_;
    if (pins) {
      pins->tips.clear();  // those were of the scans of another tablet
    }
    open_session({session_->device(), *folder, pins, false, given_up_});
  }

  bool draw_frame() {
    go_to_next_session();
    if (loaded_px_ != ui_.preferences.font_px) {
      const TimedWork timed(ui_.watch, "letters");
      ui_.fonts = load_fonts(ui_.preferences.font_px);
      if (loaded_px_ > 0) {
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
      }
      loaded_px_ = ui_.preferences.font_px;
    }
    apply_theme(ui_.preferences);
    ui_.colours = colours_of(ui_.preferences);
    ui_.time_s = now_s();
    gui_.new_frame();
    if (script_) {
      script_->inject(ui_, ui_.time_s);
    }
    ui_.targets.clear();
    ui_.facts.clear();
    ImGui::NewFrame();
    // Whatever is open and whichever screen is shown.
    if (session_ &&
        (ImGui::IsKeyPressed(GLFW_KEY_F12, false) || ImGui::IsKeyPressed(GLFW_KEY_PAUSE, false))) {
      session_->halt();
    }
    ui_.keys.begin(!pair_ && !looks_);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    bool unfinished = false;
    if (pair_) {
      pair_->draw(ui_, size);
      draws_on_ = unfinished = pair_->unfinished();
    } else if (looks_) {
      viewer_->draw(ui_, size);
      draws_on_ = unfinished = viewer_->unfinished();
      looks_ = !viewer_->wants_scanning();
    } else {
      operator_->draw(ui_, size);
      unfinished = operator_->unfinished();
      draws_on_ = operator_->draws_on();
      if (operator_->wants_viewer()) {
        const LiveState state = session_->state();
        viewer_->show_pins(operator_->pins_on_model());
        viewing_->show(state.mesh, state.tablet_from_model, session_->folder() / "analysis" / "wedges.json");
        looks_ = true;
      }
    }
    ui_.keys.end();
    if (operator_) {
      if (const std::string title = operator_->title(); title != title_) {
        title_ = title;
        glfwSetWindowTitle(window_.handle(), title_.c_str());
      }
    }
    ImGui::Render();
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window_.handle(), &width, &height);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    const Eigen::Vector4f ground = ui_.colours.panel;
    glClearColor(ground.x(), ground.y(), ground.z(), 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    return unfinished;
  }

  Status take_screenshot(bool moving) {
    if (!script_) {
      return {};
    }
    const auto file = script_->screenshot_due(!moving);
    if (!file) {
      return {};
    }
    ui_.watch.leave_out();
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window_.handle(), &width, &height);
    return write_picture(*file, read_window(width, height), {.title = "Dubsar"});
  }

  /// Why the mesh that the window was opened for cannot be shown at all.
  [[nodiscard]] std::optional<Error> mesh_error() const {
    if (session_) {
      return std::nullopt;
    }
    for (const MeshViewing* viewing : {viewing_.get(), other_viewing_.get()}) {
      if (const ViewedMesh state = viewing != nullptr ? viewing->state() : ViewedMesh();
          state.error && !state.mesh) {
        return state.error;
      }
    }
    return std::nullopt;
  }

  /// From a profile's arrival to the end of the first frame that shows it.
  void tell_profile_waits() {
    if (!profile_waits_s_.empty()) {
      std::ranges::sort(profile_waits_s_);
      const std::size_t n = profile_waits_s_.size();
      log_debug(fmt::format("profile to picture: {:.0f} ms median, {:.0f} ms 95 %, {:.0f} ms at most, of {}",
                            1000 * profile_waits_s_[n / 2], 1000 * profile_waits_s_[(n - 1) * 19 / 20],
                            1000 * profile_waits_s_.back(), n));
    }
  }

  void keep_preferences() {
    if (!(kept_ == ui_.preferences)) {
      kept_ = ui_.preferences;
      write_preferences(preferences_file_, kept_);
    }
  }

  GlWindow window_;
  GuiScope gui_;
  std::optional<ScriptPlayer> script_;
  UiContext ui_;
  Preferences kept_;
  std::filesystem::path preferences_file_;
  float loaded_px_ = 0;
  std::string title_;
  double opened_s_;
  std::vector<double> profile_waits_s_;  ///< a frame each, of the profile that waited longest
  bool draws_on_ = false;                ///< more of the picture comes at the next frame
  bool seen_ = false;                    ///< a mesh in the viewer
  bool looks_ = false;                   ///< the viewer; else the operator's screen
  std::optional<PinSet> pins_;           ///< that the window was opened with
  std::function<void(const Error&)> given_up_;
  // The screens go before the context does.
  std::unique_ptr<LiveSession> session_;
  std::unique_ptr<MeshViewing> viewing_;
  std::unique_ptr<MeshViewing> other_viewing_;
  std::unique_ptr<PairScreen> pair_;
  std::unique_ptr<OperatorScreen> operator_;
  std::unique_ptr<ViewerScreen> viewer_;
};

}  // namespace

Result<int> run_station_window(const StationWindowOptions& options, JobContext& job) {
  const double opened_s = now_s();
  make_loops_yield();
  auto script = load_script(options.script);
  if (!script) {
    return std::unexpected(script.error());
  }
  Result<GlWindow> window = GlWindow::open(options.width, options.height, "Dubsar");
  if (!window) {
    return std::unexpected(window.error());
  }
  log_debug("drawn by " + window->renderer());
  StationWindow station(std::move(*window), options, std::move(*script), opened_s);
  return station.run(job);
}

}  // namespace dubsar::ui
