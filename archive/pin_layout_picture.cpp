// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pin_layout_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "archive/glyphs.h"
#include "archive/six_views.h"
#include "core/mesh_query.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr Rgb8 kClay{196, 164, 128};
constexpr Rgb8 kPin{40, 84, 160};
constexpr Rgb8 kInk{20, 20, 20};
constexpr int kRoundSteps = 16;
constexpr int kMarginPx = 48;  // room for numbers
constexpr int kTextScale = 2;

/// A body of revolution about the pin's axis: (distance along the arm, radius) from the tip's front to the
/// arm's drawn end.
void add_pin(Mesh& mesh, const PicturedPin& pin, double radius_mm, double length_mm) {
  const Eigen::Vector3d u = pin.arm.unitOrthogonal();
  const Eigen::Vector3d v = pin.arm.cross(u);
  std::vector<std::array<double, 2>> profile;
  constexpr int kBallSteps = 6;
  for (int i = 0; i <= kBallSteps; ++i) {
    const double angle = kPi * i / (kBallSteps + 1.0);
    profile.push_back({-radius_mm * std::cos(angle), std::max(1e-3, radius_mm * std::sin(angle))});
  }
  profile.push_back({radius_mm, 0.5 * radius_mm});
  profile.push_back({length_mm, radius_mm});
  profile.push_back({length_mm, 1e-3});
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [along, radius] : profile) {
    for (int k = 0; k < kRoundSteps; ++k) {
      const double angle = 2.0 * kPi * k / kRoundSteps;
      const Eigen::Vector3d p =
          pin.tip_mm + along * pin.arm + radius * (std::cos(angle) * u + std::sin(angle) * v);
      mesh.positions.push_back(p.cast<float>());
      mesh.colours.push_back(kPin);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (std::uint32_t k = 0; k < kRoundSteps; ++k) {
      const std::uint32_t a = base + ring * kRoundSteps + k;
      const std::uint32_t b = base + ring * kRoundSteps + (k + 1) % kRoundSteps;
      mesh.faces.push_back({a, b, a + kRoundSteps});
      mesh.faces.push_back({b, b + kRoundSteps, a + kRoundSteps});
    }
  }
}

/// Each face with corners of its own: flat shading keeps the tablet's edges sharp to the eye.
Mesh flat(const Mesh& tablet) {
  Mesh mesh;
  for (const auto& face : tablet.faces) {
    const bool sound = std::all_of(face.begin(), face.end(), [&](std::uint32_t v) {
      return v < tablet.positions.size() && tablet.positions[v].allFinite();
    });
    if (!sound) {
      continue;
    }
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (const std::uint32_t v : face) {
      mesh.positions.push_back(tablet.positions[v]);
      mesh.colours.push_back(kClay);
    }
    mesh.faces.push_back({base, base + 1, base + 2});
  }
  return mesh;
}

}  // namespace

Result<Image> pin_layout_picture(const Mesh& tablet, std::span<const PicturedPin> pins,
                                 const JobContext& job) {
  Mesh mesh = flat(tablet);
  if (mesh.faces.empty()) {
    return fail(ErrorKind::kBadInput, "no tablet to draw", "pin picture", "give a mesh with faces");
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    box.extend(p);
  }
  const MeshQuery clay(mesh);
  const double size_mm = box.sizes().maxCoeff();
  const double radius_mm = std::max(0.5, 0.012 * size_mm);
  const double length_mm = 0.18 * size_mm;
  for (const PicturedPin& pin : pins) {
    add_pin(mesh, pin, radius_mm, length_mm);
  }
  const RenderScene scene(mesh);
  SixViewOptions options;
  options.render.style = RenderStyle::kColours;
  options.render.longest_px = 640;
  options.render.margin_px = kMarginPx;
  Result<SixViews> views = render_six_views(scene, options, job);
  if (!views) {
    return std::unexpected(views.error());
  }
  for (const Face face : kSixViewOrder) {
    const ViewCamera camera = face_camera(face);
    RenderOptions render = options.render;
    Image& image = views->of[static_cast<std::size_t>(face)];
    render.mm_per_px = image.mm_per_px;
    const Result<Framing> framing = framing_of(scene, camera, render);
    if (!framing) {
      return std::unexpected(framing.error());
    }
    std::vector<Eigen::Vector3i> numbers;  // middle and half width, px
    const Eigen::Vector3d to_viewer = camera.view_from_model.row(2).transpose();
    for (const PicturedPin& pin : pins) {
      const Eigen::Vector3d far_mm = pin.tip_mm + 4.0 * size_mm * to_viewer;
      if (clay.occluded(pin.tip_mm.cast<float>(), far_mm.cast<float>(), 0.01F)) {
        continue;
      }
      const std::string number = std::to_string(pin.number);
      const Eigen::Vector3d end =
          camera.view_from_model * (pin.tip_mm + (length_mm + 2.0 * radius_mm) * pin.arm);
      const int x = static_cast<int>(std::lround((end.x() - framing->left_mm) / framing->mm_per_px));
      int y = static_cast<int>(std::lround((framing->top_mm - end.y()) / framing->mm_per_px));
      const int half = text_width(number, kTextScale) / 2;
      const auto taken = [&] {
        return std::any_of(numbers.begin(), numbers.end(), [&](const Eigen::Vector3i& other) {
          return std::abs(other.x() - x) < other.z() + half &&
                 std::abs(other.y() - y) < kGlyphHeight * kTextScale;
        });
      };
      while (taken()) {  // pins one behind the other: the numbers stand in a column
        y += kGlyphHeight * kTextScale;
      }
      numbers.emplace_back(x, y, half);
      draw_text(image, x - text_width(number, kTextScale) / 2, y - kGlyphHeight * kTextScale / 2, number,
                kInk, kTextScale);
    }
  }
  return six_view_sheet(*views, options);
}

}  // namespace dubsar
