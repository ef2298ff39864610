// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/render.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"

namespace dubsar {

namespace {

constexpr int kMaxSidePx = 16384;
constexpr double kMaxSubpixels = 400e6;
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
                "the picture would be too large at " + fixed_text(framing.mm_per_px, 6) + " mm per pixel",
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

Result<std::vector<Image>> render_looks(const RenderScene& scene, const ViewCamera& camera,
                                        const RenderOptions& options, std::span<const Look> looks,
                                        const JobContext& job) {
  const Result<Framing> framing = framing_of(scene, camera, options);
  if (!framing) {
    return std::unexpected(framing.error());
  }
  const auto cancelled = [&] { return fail(ErrorKind::kCancelled, "stopped", "rendering"); };
  if (job.cancelled()) {
    return cancelled();
  }
  const VisibilityBuffer buffer = rasterise(scene, camera, *framing, options.supersampling);
  std::vector<Image> images;
  for (const Look& look : looks) {
    if (job.cancelled()) {
      return cancelled();
    }
    const SurfacePixels pixels = resolve(buffer, scene, camera, look.style, options.supersampling, look.tone);
    if (job.cancelled()) {
      return cancelled();
    }
    RenderOptions lit = options;
    lit.lighting = look.lighting;
    images.push_back(shade(pixels, lit, framing->mm_per_px));
  }
  return images;
}

Result<Image> render(const RenderScene& scene, const ViewCamera& camera, const RenderOptions& options,
                     const JobContext& job) {
  const Look look{options.style, options.lighting, {}};
  Result<std::vector<Image>> images = render_looks(scene, camera, options, {&look, 1}, job);
  if (!images) {
    return std::unexpected(images.error());
  }
  return std::move(images->front());
}

}  // namespace dubsar
