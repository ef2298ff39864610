// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>

#include "archive/colour.h"
#include "archive/render.h"
#include "archive/screen_light.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

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

/// Radiance scaling: how strong a bend reads fully, and within which reach. A wedge's edges are sharper than
/// a tenth of a millimetre; the noise of single samples is not to be seen.
constexpr double kBendMm = 0.6;
constexpr double kRadiusMm = 0.16;

/// Everything up to kKnee is kept; what is lighter is bent to stay below 1, so that lit ridges keep their
/// shape.
float shoulder(float light) {
  constexpr float kKnee = 0.7F;
  return light <= kKnee ? light
                        : kKnee + (1.0F - kKnee) * (1.0F - std::exp(-(light - kKnee) / (1.0F - kKnee)));
}

/// One pixel's light, by the way of lighting.
class Shader {
 public:
  Shader(const SurfacePixels& pixels, const RenderOptions& options, double mm_per_px)
      : pixels_(pixels),
        options_(options),
        lights_{options.towards_lamp.normalized().cast<float>()},
        relief_(static_cast<float>(options.relief)) {
    if (options.lighting == Lighting::kRaking) {
      sky_ = sky_visibility(pixels, mm_per_px, options.recess_radius_mm);
      lamp_ = lamp_visibility(pixels, mm_per_px, options.shadow_reach_mm, options.towards_lamp.normalized());
      bend_ = bending(pixels, mm_per_px, 0.6);
    } else if (options.lighting == Lighting::kRadiance) {
      bend_ = bending_within(pixels, mm_per_px, kBendMm, kRadiusMm);
    }
  }

  [[nodiscard]] LinearRgb operator()(std::size_t i, const LinearRgb& surface) const {
    switch (options_.lighting) {
      case Lighting::kFlat:
        return surface;
      case Lighting::kRadiance:
        return radiance(i, surface);
      case Lighting::kRaking:
        break;
    }
    return raking(i, surface);
  }

 private:
  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const {
    return Eigen::Vector3f(pixels_.nx[i], pixels_.ny[i], pixels_.nz[i]).normalized();
  }

  [[nodiscard]] LinearRgb raking(std::size_t i, const LinearRgb& surface) const {
    const Eigen::Vector3f n = normal(i);
    const float open = sky_[i] * sky_[i];
    const float lambert = std::max(0.0F, n.dot(lights_.lamp)) *
                          (kShadowLight + (1.0F - kShadowLight) * lamp_[i]) * (0.4F + 0.6F * open);
    const float dome = (0.62F + 0.38F * n.y()) * open;
    const float front = n.z() * (0.5F + 0.5F * open);
    const float crease = std::exp(relief_ * bend_[i]);
    LinearRgb seen{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float light = (lambert * lights_.lamp_colour[k] + dome * lights_.sky_colour[k] +
                           front * lights_.front_colour[k]) *
                          crease;
      seen[k] = shoulder(surface[k] * light);
    }
    return seen;
  }

  /// Vergne, Pacanowski, Barla, Granier, Schlick 2010, eq. 1 to 3: the reflected light delta is scaled by
  /// sigma(delta, kappa), which is 1 on flat clay. bending_within() is 0 at silhouettes already.
  [[nodiscard]] LinearRgb radiance(std::size_t i, const LinearRgb& surface) const {
    constexpr float kAlpha = 0.1F;
    constexpr float kAmbient = 0.25F;
    const Eigen::Vector3f lamp = (lights_.lamp + Eigen::Vector3f(0, 0, 0.9F)).normalized();
    const float delta = kAmbient + (1.0F - kAmbient) * std::max(0.0F, normal(i).dot(lamp));
    const float falls = std::exp(-bend_[i]);
    const float sigma = (kAlpha * falls + delta * (1.0F - kAlpha - kAlpha * falls)) /
                        (kAlpha + delta * (falls - kAlpha - kAlpha * falls));
    LinearRgb seen{};
    for (std::size_t k = 0; k < 3; ++k) {
      seen[k] = shoulder(surface[k] * delta * sigma);
    }
    return seen;
  }

  const SurfacePixels& pixels_;
  const RenderOptions& options_;
  Lights lights_;
  float relief_;
  std::vector<float> sky_, lamp_, bend_;
};

}  // namespace

Image shade(const SurfacePixels& pixels, const RenderOptions& options, double mm_per_px) {
  const Shader shader(pixels, options, mm_per_px);
  Image image = filled_image(pixels.width, pixels.height, options.background);
  image.mm_per_px = mm_per_px;
  const LinearRgb ground = to_linear(options.background);
  const auto width = static_cast<std::size_t>(pixels.width);
  parallel_chunks(static_cast<std::size_t>(pixels.height), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      const float coverage = pixels.coverage[i];
      if (coverage == 0) {
        continue;
      }
      const LinearRgb surface{pixels.r[i], pixels.g[i], pixels.b[i]};
      const LinearRgb lit = shader(i, surface);
      LinearRgb seen{};
      for (std::size_t k = 0; k < 3; ++k) {
        const float painted = lit[k] + pixels.plain[i] * (surface[k] - lit[k]);
        seen[k] = ground[k] + coverage * (painted - ground[k]);
      }
      const Rgb8 colour = to_srgb(seen);
      std::copy(colour.begin(), colour.end(), image.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
  });
  return image;
}

}  // namespace dubsar
