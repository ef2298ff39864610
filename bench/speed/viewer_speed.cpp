// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-viewer-speed: what it takes to look at a mesh, in the viewer's own view, off screen.
//   dubsar-viewer-speed open MESH    seconds from the file to the first picture, by step, and to all faces
//   dubsar-viewer-speed turn MESH    milliseconds a picture while it is turned, at several zooms
//   dubsar-viewer-speed frames MESH  frames a second with every face drawn, beside a bare draw of them, and
//                                    what it takes to select all; --faces MILLIONS: of a body made for it
//   dubsar-viewer-speed pick         faces selected and drawn by number beyond 2^16 and 2^24, checked one by
//   one
// Without a display it starts one of its own (Xvfb, drawn by the processor); --card takes a graphics card
// that no display is on.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "bench/speed/viewer_frames.h"
#include "bench/support/opened_view.h"
#include "bench/support/options.h"
#include "bench/support/peak_memory.h"
#include "bench/support/pebble.h"
#include "bench/support/statistics.h"
#include "core/stage_times.h"
#include "formats/mesh_io.h"
#include "station/picture_file.h"
#include "tests/support/raster_mesh.h"
#include "tests/ui/support/card_context.h"
#include "tests/ui/support/display.h"
#include "ui/gl/gl_window.h"
#include "ui/view/surface_view.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;
using namespace dubsar::ui;
using Clock = std::chrono::steady_clock;

std::optional<OpenedView> open_mesh(const std::string& file) {
  const auto began = Clock::now();
  Result<Mesh> mesh = read_mesh(file);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().line().c_str());
    return std::nullopt;
  }
  std::printf("%s: %zu faces, %zu vertices\n", file.c_str(), mesh->faces.size(), mesh->positions.size());
  const double read_s = told("read", began);
  return open_view(*mesh, read_s);
}

int time_opening(const std::string& file) {
  if (!open_mesh(file)) {
    return 2;
  }
  std::printf("  %-34s %7.2f GiB\n", "peak of memory", peak_gib());
  return 0;
}

int time_turning(const std::string& file) {
  constexpr int kPictures = 40;
  std::optional<OpenedView> opened = open_mesh(file);
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

/// A flat sheet of 2 cells² faces, 40 mm wide, seen from +z.
Mesh sheet(std::uint32_t cells) {
  Mesh mesh;
  const float mm = 40.0F / static_cast<float>(cells);
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      mesh.positions.emplace_back(mm * static_cast<float>(x), mm * static_cast<float>(y), 0.0F);
    }
  }
  test::add_raster_faces(mesh, 0, cells);
  return mesh;
}

/// A triangle on the screen, and every face by hand against what the card says. Faces whose middle lies
/// within `near_px` of the rim may go either way. Returns how many are wrong.
std::size_t wrongly_selected(SurfaceView& view, const ShownMesh& shown, const OrbitCamera& camera) {
  constexpr float kNearPx = 1.0F;
  const std::vector<Eigen::Vector2f> corners{{300.3F, 150.2F}, {1500.7F, 400.4F}, {700.1F, 1100.6F}};
  const auto began = Clock::now();
  view.select(MeshElement::kFace, corners, SelectionStep::kUnion, true);
  while (view.select_more()) {
  }
  const BitMarks& selected = *view.selection()->selected();
  told("select by a polygon, and read back", began);
  std::size_t wrong = 0;
  std::size_t inside = 0;
  for (std::size_t f = 0; f < shown.faces.size(); ++f) {
    const auto& [a, b, c] = shown.faces[f];
    const Eigen::Vector2f at = camera.pixel_of(
        (shown.positions[a] + shown.positions[b] + shown.positions[c]) / 3.0F, {kWidth, kHeight});
    float least = std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2f edge = corners[(k + 1) % 3] - corners[k];
      const Eigen::Vector2f to = at - corners[k];
      least = std::min(least, (edge.x() * to.y() - edge.y() * to.x()) / edge.norm());
    }
    inside += selected[f] ? 1 : 0;
    wrong += std::abs(least) > kNearPx && (least > 0) != selected[f] ? 1 : 0;
  }
  std::printf("  %zu of %zu faces selected, %zu of them wrong\n", inside, shown.faces.size(), wrong);
  return wrong;
}

/// Single faces are marked by their number and looked at closely. Returns how many are drawn wrong.
std::size_t wrongly_drawn(SurfaceView& view, const ShownMesh& shown, OrbitCamera camera) {
  std::size_t wrong = 0;
  for (const std::size_t face :
       {std::size_t{5}, (std::size_t{1} << 16U) + 1, (std::size_t{1} << 20U) + 3, (std::size_t{1} << 24U) - 1,
        (std::size_t{1} << 24U) + 1, (std::size_t{1} << 24U) + 2, shown.faces.size() - 1}) {
    if (face >= shown.faces.size()) {
      continue;
    }
    BitMarks marks(shown.faces.size());
    marks.mark(face);
    view.set_selection(MeshElement::kFace, std::make_shared<const BitMarks>(std::move(marks)));
    const auto& [a, b, c] = shown.faces[face];
    camera.centre_mm = (shown.positions[a] + shown.positions[b] + shown.positions[c]) / 3.0F;
    camera.half_height_mm = 8 * (shown.positions[b] - shown.positions[a]).norm();
    view.draw_whole(camera, {}, kWidth, kHeight);
    const Image picture = view.read();
    std::size_t blue = 0;
    for (std::size_t i = 0; i + 3 < picture.bytes.size(); i += 4) {
      blue += picture.bytes[i + 2] > picture.bytes[i] + 20 ? 1 : 0;
    }
    const std::size_t middle =
        4 * (static_cast<std::size_t>(kHeight) / 2 * kWidth + static_cast<std::size_t>(kWidth) / 2);
    const double px = static_cast<double>(camera.mm_per_px(kHeight));
    const double area_px =
        0.5 *
        static_cast<double>(
            (shown.positions[b] - shown.positions[a]).cross(shown.positions[c] - shown.positions[a]).norm()) /
        (px * px);
    const bool right = picture.bytes[middle + 2] > picture.bytes[middle] + 20 &&
                       std::abs(static_cast<double>(blue) - area_px) < 0.1 * area_px;
    std::printf("  face %9zu: %zu px blue, %.0f expected%s\n", face, blue, area_px, right ? "" : ": WRONG");
    wrong += right ? 0 : 1;
  }
  return wrong;
}

int time_many_frames(const std::string& file, double millions, const std::string& picture) {
  std::optional<OpenedView> opened = file.empty() ? open_view(pebble(millions), 0) : open_mesh(file);
  if (!opened) {
    return 2;
  }
  time_frames(*opened);
  if (picture.empty()) {
    return 0;
  }
  const Status written = write_picture(picture, opened->view->read(), {.title = "viewer"});
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().line().c_str());
    return 2;
  }
  return 0;
}

int check_picking(double millions) {
  const Mesh mesh = sheet(static_cast<std::uint32_t>(std::sqrt(millions * 5e5)));
  const ShownMesh shown = shown_mesh(mesh);
  SurfaceView view;
  view.show(shown);
  OrbitCamera camera;
  camera.fit(shown.box_mm, static_cast<float>(kWidth) / kHeight);
  view.draw_whole(camera, {}, kWidth, kHeight);
  const std::size_t wrong = wrongly_selected(view, shown, camera) + wrongly_drawn(view, shown, camera);
  return wrong == 0 ? 0 : 1;
}

/// With the context until that ends; status 3 without one.
template <class Context, class Run>
int with_context(const Result<Context>& context, const Run& run) {
  if (!context) {
    std::fprintf(stderr, "%s\n", context.error().line().c_str());
    return 3;
  }
  return run(context->renderer());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What it takes to look at a mesh");
  app.require_subcommand(1);
  bool card = false;
  app.add_flag("--card", card, "a graphics card without a display (EGL)");
  std::string mesh;
  CLI::App* opening = app.add_subcommand("open", "from the file to the picture");
  CLI::App* turning = app.add_subcommand("turn", "pictures of a mesh that is turned");
  for (CLI::App* verb : {opening, turning}) {
    verb->add_option("mesh", mesh, "PLY, OBJ, STL or GLB")->required();
  }
  double millions = 20;
  std::string picture;
  CLI::App* frames = app.add_subcommand("frames", "frames a second, every face drawn");
  frames->add_option("mesh", mesh, "PLY, OBJ, STL or GLB; else a body of --faces");
  frames->add_option("--picture", picture, "PNG that the last frame is written to");
  CLI::App* picking = app.add_subcommand("pick", "faces by number, status 1 when one is wrong");
  for (CLI::App* verb : {frames, picking}) {
    verb->add_option("--faces", millions, "millions of faces")->check(CLI::Range(0.1, 200.0));
  }
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  std::optional<dubsar::test::Display> display;
  if (!card && std::getenv("DISPLAY") == nullptr) {
    display.emplace("1920x1200x24");
  }
  const auto run = [&](const std::string& renderer) {
    std::printf("drawn by %s\n", renderer.c_str());
    if (picking->parsed()) {
      return check_picking(millions);
    }
    if (frames->parsed()) {
      return time_many_frames(mesh, millions, picture);
    }
    return opening->parsed() ? time_opening(mesh) : time_turning(mesh);
  };
  if (card) {
    return with_context(dubsar::test::CardContext::open(), run);
  }
  return with_context(GlWindow::open(64, 64, "bench"), run);
}
