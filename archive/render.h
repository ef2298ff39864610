// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "archive/image.h"
#include "archive/raster.h"
#include "archive/surface_pixels.h"
#include "core/job.h"
#include "core/result.h"

namespace dubsar {

inline constexpr Rgb8 kPaper{255, 255, 255};
inline constexpr Rgb8 kBlackGround{0, 0, 0};

/// How the surface is lit.
enum class Lighting {
  kRaking,    ///< a raking lamp with shadows, a sky and a little light from the viewer
  kRadiance,  ///< radiance scaling (Vergne et al. 2010): what bends out is lightened, what bends in darkened
  kFlat,      ///< not at all: every pixel has the colour of its style
};

/// What a picture shows of the surface.
struct Look {
  RenderStyle style = RenderStyle::kClay;
  Lighting lighting = Lighting::kRaking;
  std::span<const float> tone{};  ///< [V], for RenderStyle::kTone
};

/// A part of the picture to draw instead of the whole object.
struct RenderWindow {
  Eigen::Vector3d center_mm{0, 0, 0};  ///< model frame
  double width_mm = 10;
  double height_mm = 10;
};

struct RenderOptions {
  double mm_per_px = 0.0;  ///< scale of the picture; 0 makes the longest side of the object longest_px
  int longest_px = 1200;
  int supersampling = 2;  ///< subpixels per pixel and axis, 1 to 4
  int margin_px = 6;
  Rgb8 background = kPaper;
  RenderStyle style = RenderStyle::kClay;
  Lighting lighting = Lighting::kRaking;
  /// Towards the lamp, x right, y up, z to the viewer: raking from the upper left, as epigraphers light a
  /// tablet, about 36 degrees above it. Need not be a unit vector.
  Eigen::Vector3d towards_lamp{-0.62, 0.52, 0.58};
  double recess_radius_mm = 2.5;  ///< surroundings that take light from a recess; a wedge is 1 to 5 mm
  double shadow_reach_mm = 4.0;
  std::optional<RenderWindow> window;  ///< needs mm_per_px; there is no margin round it then
  double relief = 0.3;                 ///< how far ridges are lightened and valleys darkened, 0 to 1

  [[nodiscard]] Status check() const;
};

/// Draws the scene to scale on the CPU. The picture is as large as the object needs at mm_per_px, margins
/// included, and carries its scale. Same scene and options: same bytes. Errors: bad options (kUsage), nothing
/// to draw (kBadInput), a picture that would be too large (kUsage), cancelled.
[[nodiscard]] Result<Image> render(const RenderScene& scene, const ViewCamera& camera,
                                   const RenderOptions& options, const JobContext& job);

/// The same view in several looks, which take the place of the options' own: the surface is projected once.
/// In the order of the looks; otherwise as render().
[[nodiscard]] Result<std::vector<Image>> render_looks(const RenderScene& scene, const ViewCamera& camera,
                                                      const RenderOptions& options,
                                                      std::span<const Look> looks, const JobContext& job);

/// Lights pixels, however they came about; mm_per_px is their scale.
[[nodiscard]] Image shade(const SurfacePixels& pixels, const RenderOptions& options, double mm_per_px);

/// The scale that makes the longest side of the object, over all six faces, longest_px long. 0 for an empty
/// scene.
[[nodiscard]] double scale_for(const RenderScene& scene, const RigidTransform& tablet_from_model,
                               int longest_px);

/// The framing that render() uses.
[[nodiscard]] Result<Framing> framing_of(const RenderScene& scene, const ViewCamera& camera,
                                         const RenderOptions& options);

}  // namespace dubsar
