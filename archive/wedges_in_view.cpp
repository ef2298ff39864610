// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/wedges_in_view.h"

namespace dubsar {

namespace {

/// sin 15°.
constexpr double kLeastTowardsViewer = 0.259;
/// Corners lie where the idealised planes meet, a little above or below the clay.
constexpr double kOffTheClayMm = 0.3;
/// A corner is looked for a little inwards: past the rim of the tablet there may be nothing to hide it.
constexpr double kInwards = 0.1;

Eigen::Vector2d pixel_of(const Eigen::Vector3d& p_in_view_mm, const Framing& framing) {
  return {(p_in_view_mm.x() - framing.left_mm) / framing.mm_per_px,
          (framing.top_mm - p_in_view_mm.y()) / framing.mm_per_px};
}

bool is_hidden(const Eigen::Vector3d& p_in_view_mm, const Framing& framing, const VisibilityBuffer& seen) {
  const Eigen::Vector2d pixel = pixel_of(p_in_view_mm, framing);
  if (!(pixel.x() >= 0 && pixel.x() < seen.width && pixel.y() >= 0 && pixel.y() < seen.height)) {
    return true;
  }
  const std::size_t at = static_cast<std::size_t>(pixel.y()) * static_cast<std::size_t>(seen.width) +
                         static_cast<std::size_t>(pixel.x());
  return seen.id[at] == kNothing ||
         static_cast<double>(seen.z_mm[at]) > p_in_view_mm.z() - framing.middle_mm + kOffTheClayMm;
}

}  // namespace

std::vector<WedgeOnPicture> wedges_in_view(const std::vector<Wedge>& wedges, const RenderScene& scene,
                                           const ViewCamera& camera, const Framing& framing) {
  const VisibilityBuffer seen = rasterise(scene, camera, framing, 1);
  std::vector<WedgeOnPicture> out;
  for (std::size_t k = 0; k < wedges.size(); ++k) {
    const Wedge& wedge = wedges[k];
    if (!(camera.view_from_model.row(2).dot(wedge.surface_normal.normalized()) >= kLeastTowardsViewer)) {
      continue;
    }
    const Eigen::Vector3d middle =
        (wedge.outer_vertices_mm[0] + wedge.outer_vertices_mm[1] + wedge.outer_vertices_mm[2]) / 3;
    WedgeOnPicture on{.wedge = k};
    int open = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::Vector3d& corner = wedge.outer_vertices_mm[c];
      on.corners_px[c] = pixel_of(camera.view_from_model * corner, framing);
      const Eigen::Vector3d inner = camera.view_from_model * (corner + kInwards * (middle - corner));
      open += is_hidden(inner, framing, seen) ? 0 : 1;
    }
    if (open >= 2) {
      out.push_back(on);
    }
  }
  return out;
}

}  // namespace dubsar
