// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/render.h"

#include <algorithm>
#include <cmath>

#include "archive/colour.h"
#include "archive/screen_light.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr int kMaxSidePx = 16384;
constexpr double kMaxSubpixels = 400e6;
constexpr float kShadowLight =
    0.3F;  // of the lamp's light stays in its shadow, so that wedges keep their faces

/// Light on clay: a warm raking lamp, a cool sky from above, and a little light from the viewer, so that no
/// side is black. Shadows take the lamp, recesses take the sky and some of the lamp.
struct Lights {
  Eigen::Vector3f lamp;
  LinearRgb lamp_colour{1.18F, 1.12F, 1.03F};
  LinearRgb sky_colour{0.37F, 0.40F, 0.46F};
  LinearRgb front_colour{0.21F, 0.21F, 0.21F};
};

/// Everything up to kKnee is kept; what is lighter is bent to stay below 1, so that lit ridges keep their
/// shape.
float shoulder(float light) {
  constexpr float kKnee = 0.7F;
  return light <= kKnee ? light
                        : kKnee + (1.0F - kKnee) * (1.0F - std::exp(-(light - kKnee) / (1.0F - kKnee)));
}

Image shade(const SurfacePixels& pixels, const RenderOptions& options, double mm_per_px) {
  const Eigen::Vector3d towards_lamp = options.towards_lamp.normalized();
  const Lights lights{towards_lamp.cast<float>()};
  const std::vector<float> sky = sky_visibility(pixels, mm_per_px, options.recess_radius_mm);
  const std::vector<float> lamp = lamp_visibility(pixels, mm_per_px, options.shadow_reach_mm, towards_lamp);
  const std::vector<float> bend = bending(pixels, mm_per_px, 0.6);
  Image image = filled_image(pixels.width, pixels.height, options.background);
  image.mm_per_px = mm_per_px;
  const LinearRgb ground = to_linear(options.background);
  const auto relief = static_cast<float>(options.relief);
  const auto width = static_cast<std::size_t>(pixels.width);

  const auto shade_pixel = [&](std::size_t i) {
    const float coverage = pixels.coverage[i];
    if (coverage == 0) {
      return;
    }
    Eigen::Vector3f n(pixels.nx[i], pixels.ny[i], pixels.nz[i]);
    n.normalize();
    const float open = sky[i] * sky[i];
    const float lambert = std::max(0.0F, n.dot(lights.lamp)) *
                          (kShadowLight + (1.0F - kShadowLight) * lamp[i]) * (0.4F + 0.6F * open);
    const float dome = (0.62F + 0.38F * n.y()) * open;
    const float front = n.z() * (0.5F + 0.5F * open);
    const float crease = std::exp(relief * bend[i]);
    const LinearRgb surface{pixels.r[i], pixels.g[i], pixels.b[i]};
    const float plain = pixels.plain[i];
    LinearRgb seen{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float light =
          (lambert * lights.lamp_colour[k] + dome * lights.sky_colour[k] + front * lights.front_colour[k]) *
          crease;
      const float lit = shoulder(surface[k] * light);
      const float painted = lit + plain * (surface[k] - lit);
      seen[k] = ground[k] + coverage * (painted - ground[k]);
    }
    const Rgb8 colour = to_srgb(seen);
    std::copy(colour.begin(), colour.end(), image.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i));
  };
  parallel_chunks(static_cast<std::size_t>(pixels.height), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      shade_pixel(i);
    }
  });
  return image;
}

}  // namespace

Status RenderOptions::check() const {
  if (!(mm_per_px >= 0) || !std::isfinite(mm_per_px)) {
    return fail(ErrorKind::kUsage, "mm per pixel must be a positive number", "rendering");
  }
  if (longest_px < 16 || longest_px > kMaxSidePx) {
    return fail(ErrorKind::kUsage, "the longest side must be 16 to 16384 pixels", "rendering");
  }
  if (supersampling < 1 || supersampling > 4) {
    return fail(ErrorKind::kUsage, "supersampling must be 1 to 4", "rendering");
  }
  if (margin_px < 0 || margin_px > 1024) {
    return fail(ErrorKind::kUsage, "the margin must be 0 to 1024 pixels", "rendering");
  }
  if (!towards_lamp.allFinite() || !(towards_lamp.norm() > 0)) {
    return fail(ErrorKind::kUsage, "the lamp needs a direction", "rendering");
  }
  if (window &&
      !(mm_per_px > 0 && window->center_mm.allFinite() && window->width_mm > 0 && window->height_mm > 0)) {
    return fail(ErrorKind::kUsage, "a window needs a scale, a place and a size", "rendering");
  }
  if (!(recess_radius_mm > 0) || !(shadow_reach_mm > 0) || !(relief >= 0 && relief <= 1)) {
    return fail(ErrorKind::kUsage, "radii must be positive and the relief 0 to 1", "rendering");
  }
  return {};
}

double scale_for(const RenderScene& scene, const RigidTransform& tablet_from_model, int longest_px) {
  const double longest_mm = scene.extent(face_camera(Face::kObverse, tablet_from_model)).size_mm().maxCoeff();
  return longest_mm > 0 ? longest_mm / longest_px : 0.0;
}

Result<Framing> framing_of(const RenderScene& scene, const ViewCamera& camera, const RenderOptions& options) {
  if (const Status checked = options.check(); !checked) {
    return std::unexpected(checked.error());
  }
  if (scene.empty()) {
    return bad_input("rendering", "the mesh has no surface to draw", "scan and stitch first");
  }
  const RenderScene::Extent extent = scene.extent(camera);
  const Eigen::Vector3d size = extent.size_mm();
  Framing framing;
  framing.mm_per_px = options.mm_per_px > 0 ? options.mm_per_px : size.maxCoeff() / options.longest_px;
  if (!(framing.mm_per_px > 0)) {
    framing.mm_per_px = 1.0;  // A single point has no size; any scale shows it.
  }
  const auto pixels = [&](double mm, int margin_px) {
    return std::ceil(mm / framing.mm_per_px - 1e-6) + 2.0 * margin_px;
  };
  const double wide =
      options.window ? pixels(options.window->width_mm, 0) : pixels(size.x(), options.margin_px);
  const double high =
      options.window ? pixels(options.window->height_mm, 0) : pixels(size.y(), options.margin_px);
  if (!(wide <= kMaxSidePx) || !(high <= kMaxSidePx) ||
      !(wide * high * options.supersampling * options.supersampling <= kMaxSubpixels)) {
    return fail(ErrorKind::kUsage,
                "the picture would be too large at " + std::to_string(framing.mm_per_px) + " mm per pixel",
                "rendering", "take more mm per pixel, or look for stray points far from the tablet");
  }
  framing.width_px = std::max(1, static_cast<int>(wide));
  framing.height_px = std::max(1, static_cast<int>(high));
  const Eigen::Vector3d middle = options.window
                                     ? Eigen::Vector3d(camera.view_from_model * options.window->center_mm)
                                     : Eigen::Vector3d(0.5 * (extent.min_mm + extent.max_mm));
  framing.left_mm = middle.x() - 0.5 * framing.width_px * framing.mm_per_px;
  framing.top_mm = middle.y() + 0.5 * framing.height_px * framing.mm_per_px;
  framing.middle_mm = middle.z();
  return framing;
}

Result<Image> render(const RenderScene& scene, const ViewCamera& camera, const RenderOptions& options,
                     const JobContext& job) {
  const Result<Framing> framing = framing_of(scene, camera, options);
  if (!framing) {
    return std::unexpected(framing.error());
  }
  const auto cancelled = [&] { return fail(ErrorKind::kCancelled, "stopped", "rendering"); };
  if (job.cancelled()) {
    return cancelled();
  }
  SurfacePixels pixels;
  {
    const VisibilityBuffer buffer = rasterise(scene, camera, *framing, options.supersampling);
    if (job.cancelled()) {
      return cancelled();
    }
    pixels = resolve(buffer, scene, camera, options.style, options.supersampling);
  }
  if (job.cancelled()) {
    return cancelled();
  }
  return shade(pixels, options, framing->mm_per_px);
}

}  // namespace dubsar
