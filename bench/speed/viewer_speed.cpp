// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-viewer-speed: what it takes to look at a mesh, in the viewer's own view, off screen.
//   dubsar-viewer-speed open MESH    seconds from the file to the first picture, by step, and to all faces
//   dubsar-viewer-speed turn MESH    milliseconds a picture while it is turned, at several zooms
//   dubsar-viewer-speed pick MESH    faces selected and drawn by number beyond 2^16 and 2^24, checked one by
//   one
// Without a display it starts one of its own (Xvfb, drawn by the processor).

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "bench/support/statistics.h"
#include "core/tablet_frame.h"
#include "formats/mesh_io.h"
#include "tests/ui/support/display.h"
#include "ui/gl/gl_window.h"
#include "ui/view/surface_view.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;
using namespace dubsar::ui;
using Clock = std::chrono::steady_clock;

constexpr int kWidth = 1920;
constexpr int kHeight = 1200;

/// A step that just ended.
double told(const char* what, Clock::time_point began) {
  const double s = seconds_since(began);
  std::printf("  %-34s %7.2f s\n", what, s);
  return s;
}

struct Opened {
  Mesh mesh;
  ShownMesh shown;
  std::unique_ptr<SurfaceView> view;
  OrbitCamera camera;
};

std::optional<Opened> open_mesh(const std::string& file) {
  Opened out;
  double sum = 0;
  auto began = Clock::now();
  Result<Mesh> mesh = read_mesh(file);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().line().c_str());
    return std::nullopt;
  }
  out.mesh = std::move(*mesh);
  std::printf("%s: %zu faces, %zu vertices\n", file.c_str(), out.mesh.faces.size(),
              out.mesh.positions.size());
  sum += told("read", began);
  began = Clock::now();
  const RigidTransform tablet_from_model = tablet_frame(out.mesh);
  sum += told("which way it lies", began);
  began = Clock::now();
  out.shown = shown_mesh(out.mesh);
  sum += told("blocks and levels of detail", began);
  for (const ShownLevel& level : out.shown.coarser) {
    std::printf("    %zu faces, cells of %.3f mm\n", level.detail.faces.size(),
                static_cast<double>(level.detail.cell_mm));
  }
  began = Clock::now();
  out.view = std::make_unique<SurfaceView>();
  out.view->show(out.shown);
  sum += told("to the graphics card", began);
  out.camera.eye_from_model = Eigen::Quaternionf(Eigen::Matrix3f(tablet_from_model.rotation.cast<float>()));
  out.camera.fit(out.shown.box_mm, static_cast<float>(kWidth) / kHeight);
  began = Clock::now();
  bool more = out.view->draw(out.camera, {}, kWidth, kHeight);
  sum += told("first picture", began);
  std::printf("  %-34s %7.2f s, %zu faces drawn, %.0f MB on the card\n", "all of it", sum,
              out.view->faces_drawn(), static_cast<double>(out.view->buffers()->bytes()) / 1e6);
  began = Clock::now();
  double longest = 0;
  while (more) {
    const auto one = Clock::now();
    more = out.view->draw(out.camera, {}, kWidth, kHeight);
    longest = std::max(longest, seconds_since(one));
  }
  told("then, until every face is there", began);
  std::printf("  %-34s %7.0f ms\n", "longest frame of that", 1000 * longest);
  return out;
}

int time_opening(const std::string& file) {
  if (!open_mesh(file)) {
    return 2;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("  %-34s %7.2f GiB\n", "peak of memory", static_cast<double>(usage.ru_maxrss) / 1048576.0);
  return 0;
}

int time_turning(const std::string& file) {
  constexpr int kPictures = 40;
  std::optional<Opened> opened = open_mesh(file);
  if (!opened) {
    return 2;
  }
  std::printf("  %8s %12s %7s %10s %10s   at %d x %d\n", "zoom", "faces drawn", "level", "median ms",
              "95 % ms", kWidth, kHeight);
  const float whole_mm = opened->camera.half_height_mm;
  for (const float zoom : {1.0F, 2.0F, 4.0F, 8.0F, 16.0F, 32.0F}) {
    OrbitCamera camera = opened->camera;
    camera.half_height_mm = whole_mm / zoom;
    std::vector<double> ms;
    std::size_t faces = 0;
    std::size_t level = 0;
    for (int k = 0; k < kPictures; ++k) {
      camera.drag({0, 0}, {0.004F, 0.002F});
      const auto began = Clock::now();
      opened->view->draw(camera, {}, kWidth, kHeight);
      ms.push_back(1000 * seconds_since(began));
      faces = opened->view->faces_drawn();
      level = opened->view->level_drawn();
    }
    std::printf("  %8.0f %12zu %3zu/%-3zu %10.1f %10.1f\n", static_cast<double>(zoom), faces, level + 1,
                opened->view->levels(), quantile(ms, 0.5), quantile(ms, 0.95));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What it takes to look at a mesh");
  app.require_subcommand(1);
  std::string mesh;
  CLI::App* opening = app.add_subcommand("open", "from the file to the picture");
  CLI::App* turning = app.add_subcommand("turn", "pictures of a mesh that is turned");
  for (CLI::App* verb : {opening, turning}) {
    verb->add_option("mesh", mesh, "PLY, OBJ, STL or GLB")->required();
  }
  CLI11_PARSE(app, argc, argv);
  std::optional<dubsar::test::Display> display;
  if (std::getenv("DISPLAY") == nullptr) {
    display.emplace("1920x1200x24");
  }
  Result<GlWindow> window = GlWindow::open(64, 64, "bench");
  if (!window) {
    std::fprintf(stderr, "%s\n", window.error().line().c_str());
    return 3;
  }
  std::printf("drawn by %s\n", window->renderer().c_str());
  return opening->parsed() ? time_opening(mesh) : time_turning(mesh);
}
