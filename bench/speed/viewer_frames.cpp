// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/speed/viewer_frames.h"

#include <epoxy/gl.h>

#include <cstdio>
#include <functional>
#include <vector>

#include "bench/support/statistics.h"
#include "core/stage_times.h"
#include "ui/gl/frame_target.h"
#include "ui/gl/shader_program.h"

namespace dubsar::bench {

namespace {

using Clock = std::chrono::steady_clock;
using namespace dubsar::ui;

constexpr int kWarmUp = 10;
constexpr int kFrames = 100;
/// So long at most for a line of the table: a processor that draws takes seconds a frame.
constexpr double kMostS = 5;

constexpr const char* kBareVertex = R"glsl(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_model;
void main() { gl_Position = clip_from_model * vec4(position, 1.0); }
)glsl";

constexpr const char* kBareFragment = R"glsl(#version 410 core
layout(location = 0) out vec4 colour;
void main() { colour = vec4(1.0); }
)glsl";

/// Milliseconds a frame while the camera turns, each frame waited for; the first few are not counted.
std::vector<double> ms_while_turned(OrbitCamera camera, const std::function<void(const OrbitCamera&)>& draw) {
  std::vector<double> ms;
  const auto began = Clock::now();
  for (int k = 0; k < kWarmUp + kFrames && (ms.empty() || seconds_since(began) < kMostS); ++k) {
    camera.drag({0, 0}, {0.004F, 0.002F});
    const auto frame = Clock::now();
    draw(camera);
    glFinish();
    if (k >= kWarmUp || seconds_since(began) > kMostS / 2) {
      ms.push_back(1000 * seconds_since(frame));
    }
  }
  return ms;
}

/// Prints a line of the table; the median.
double told_frames(const char* what, const std::vector<double>& ms, double bare_ms) {
  const double median = quantile(ms, 0.5);
  std::printf("  %-44s %8.2f %8.2f %8.0f %7.2f\n", what, median, quantile(ms, 0.95), 1000 / median,
              bare_ms > 0 ? median / bare_ms : 1.0);
  return median;
}

Look every_shading() {
  Look look;
  look.occlusion = true;
  look.radiance = 0.8F;
  look.depth_shading = 0.5F;
  look.ground = {1, 1, 1, 1};
  return look;
}

double time_bare(const OpenedView& opened) {
  ShaderProgram bare(kBareVertex, kBareFragment);
  FrameTarget target({PixelFormat::kRgba8});
  target.resize(kWidth, kHeight);
  const MeshBuffers& buffers = *opened.view->buffers();
  const auto ms = ms_while_turned(opened.camera, [&](const OrbitCamera& camera) {
    target.bind();
    glEnable(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bare.use();
    bare.set("clip_from_model", camera.clip_from_model(static_cast<float>(kWidth) / kHeight));
    buffers.bind();
    buffers.draw_faces(0, buffers.faces());
  });
  return told_frames("bare indexed draw", ms, 0);
}

/// All that the picture holds is selected, and back where the program has it.
void time_selecting(OpenedView& opened, MeshElement of, bool through) {
  opened.view->draw_whole(opened.camera, every_shading(), kWidth, kHeight);
  glFinish();
  const std::vector<Eigen::Vector2f> all{
      {-1, -1}, {kWidth + 1, -1}, {kWidth + 1, kHeight + 1}, {-1, kHeight + 1}};
  std::vector<double> ms;
  std::size_t selected = 0;
  for (int k = 0; k < 12; ++k) {
    opened.view->clear_selection();
    const auto began = Clock::now();
    if (!opened.view->select(of, all, SelectionStep::kUnion, through)) {
      std::printf("  cannot select here\n");
      return;
    }
    while (opened.view->select_more()) {
    }
    ms.push_back(1000 * seconds_since(began));
    selected = opened.view->selection()->selected()->marked();
    opened.view->draw_whole(opened.camera, every_shading(), kWidth, kHeight);
    glFinish();
  }
  std::printf("  select %s, %-26s %8.2f ms (first %.2f, least %.2f), %zu selected\n",
              of == MeshElement::kFace ? "faces" : "points", through ? "through" : "only what is seen",
              quantile(ms, 0.5), ms.front(), quantile(ms, 0), selected);
  opened.view->clear_selection();
}

}  // namespace

void time_frames(OpenedView& opened) {
  SurfaceView& view = *opened.view;
  std::printf("  %-44s %8s %8s %8s %7s   at %d x %d, %zu faces\n", "", "ms", "95 %", "1/s", "ratio", kWidth,
              kHeight, view.buffers()->faces());
  const double bare_ms = time_bare(opened);
  const auto whole = [&](const char* what, const Look& look) {
    told_frames(
        what,
        ms_while_turned(opened.camera,
                        [&](const OrbitCamera& camera) { view.draw_whole(camera, look, kWidth, kHeight); }),
        bare_ms);
  };
  Look look = every_shading();
  whole("all faces, sphere, all shading", look);
  look.depth_shading = 0;
  whole("all faces, sphere, without depth shading", look);
  look = every_shading();
  look.overlay = Overlay::kFlags;
  whole("all faces, sphere, all shading, red", look);
  look = every_shading();
  look.lamp = true;
  look.shadows = false;
  whole("all faces, lamp without shadows, all shading", look);
  look.shadows = true;
  whole("all faces, lamp and shadows, all shading", look);
  told_frames(
      "fewest faces, lamp and shadows, all shading",
      ms_while_turned(opened.camera,
                      [&](const OrbitCamera& camera) { view.draw_level(0, camera, look, kWidth, kHeight); }),
      bare_ms);
  for (const bool lamp : {false, true}) {
    look.lamp = lamp;
    const auto ms = ms_while_turned(
        opened.camera, [&](const OrbitCamera& camera) { view.draw(camera, look, kWidth, kHeight); });
    told_frames(lamp ? "as the window turns it, lamp and shadows" : "as the window turns it, sphere", ms,
                bare_ms);
    std::printf("  %-44s %zu faces, level %zu of %zu\n", "", view.faces_drawn(), view.level_drawn() + 1,
                view.levels());
  }
  time_selecting(opened, MeshElement::kFace, true);
  time_selecting(opened, MeshElement::kFace, false);
  time_selecting(opened, MeshElement::kVertex, true);
  view.draw_whole(opened.camera, look, kWidth, kHeight);
}

}  // namespace dubsar::bench
