// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/screen_light.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr int kDirections = 12;
constexpr int kMaxReachPx = 96;
constexpr std::size_t kRowGrain = 16;

/// Depths with a rim of kFarAway, so that no step needs a bounds check.
struct PaddedDepth {
  int pad = 0;
  std::size_t stride = 0;
  std::vector<float> z_mm;

  PaddedDepth(const SurfacePixels& pixels, int pad_px) : pad(pad_px) {
    stride = static_cast<std::size_t>(pixels.width + 2 * pad);
    z_mm.assign(stride * static_cast<std::size_t>(pixels.height + 2 * pad), kFarAway);
    for (int y = 0; y < pixels.height; ++y) {
      const auto from = pixels.z_mm.begin() + static_cast<std::ptrdiff_t>(y) * pixels.width;
      std::copy(from, from + pixels.width,
                z_mm.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y + pad) * stride) + pad);
    }
  }
  [[nodiscard]] const float* row(std::size_t y, int dx, int dy) const {
    return z_mm.data() + (y + static_cast<std::size_t>(pad + dy)) * stride +
           static_cast<std::size_t>(pad + dx);
  }
};

struct Step {
  int dx = 0, dy = 0;  ///< pixels, dy downwards
  float ux = 0,
        uy = 0;  ///< unit vector of this step, uy upwards: whole pixels rarely lie on the line asked for
  float distance_mm = 0;
  float fade = 1;
};

int reach_px(double reach_mm, double mm_per_px) {
  return std::clamp(static_cast<int>(std::ceil(reach_mm / mm_per_px)), 2, kMaxReachPx);
}

/// Steps outwards along (ux, uy), y upwards, whose lengths grow by `growth`; pixels that repeat are left out.
std::vector<Step> steps_along(double ux, double uy, int reach, double growth, double mm_per_px) {
  std::vector<Step> steps;
  for (double r = 1.0; r <= reach; r = std::max(r + 1.0, r * growth)) {
    const int dx = static_cast<int>(std::lround(ux * r));
    const int dy = static_cast<int>(std::lround(-uy * r));
    const double px = std::hypot(dx, dy);
    const double share = px / (reach + 1.0);
    steps.push_back({dx, dy, static_cast<float>(dx / px), static_cast<float>(-dy / px),
                     static_cast<float>(px * mm_per_px), static_cast<float>(1.0 - share * share)});
  }
  return steps;
}

/// What stands far in front is another part of the body: it hides the clay, it is not its surroundings.
class Surroundings {
 public:
  Surroundings(int reach, double mm_per_px) : per_too_high_(static_cast<float>(0.5 / (reach * mm_per_px))) {}
  /// How much of it counts, by how far it stands in front. It fades: were it all or nothing, stripes of light
  /// and dark would cross a slope whose depth comes about there.
  [[nodiscard]] float share(float up_mm) const {
    return std::clamp(2.0F - 2.0F * up_mm * per_too_high_, 0.0F, 1.0F);
  }

 private:
  float per_too_high_;
};

}  // namespace

std::vector<float> sky_visibility(const SurfacePixels& pixels, double mm_per_px, double radius_mm) {
  const int reach = reach_px(radius_mm, mm_per_px);
  const PaddedDepth depth(pixels, reach + 1);
  const Surroundings surroundings(reach, mm_per_px);
  const auto width = static_cast<std::size_t>(pixels.width);
  std::vector<float> open(pixels.size(), 1.0F);
  parallel_chunks(
      static_cast<std::size_t>(pixels.height), kRowGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<float> rise(width), hidden(width);
        for (std::size_t y = begin; y < end; ++y) {
          std::fill(hidden.begin(), hidden.end(), 0.0F);
          const float* here = depth.row(y, 0, 0);
          const float* nx = pixels.nx.data() + y * width;
          const float* ny = pixels.ny.data() + y * width;
          const float* nz = pixels.nz.data() + y * width;
          for (int d = 0; d < kDirections; ++d) {
            // Half a step of turn keeps the directions off the pixel axes, where lines of writing
            // run.
            const double angle = 2.0 * kPi * (d + 0.5) / kDirections;
            std::fill(rise.begin(), rise.end(), 0.0F);
            for (const Step& step : steps_along(std::cos(angle), std::sin(angle), reach, 1.6, mm_per_px)) {
              const float* there = depth.row(y, step.dx, step.dy);
              const float per_mm = 1.0F / step.distance_mm;
              for (std::size_t x = 0; x < width; ++x) {
                const float up = there[x] - here[x];
                const float tangent = -(nx[x] * step.ux + ny[x] * step.uy) / std::max(nz[x], 0.2F);
                const float above = (up * per_mm - tangent) * step.fade;
                rise[x] = std::max(rise[x], above * surroundings.share(up));
              }
            }
            for (std::size_t x = 0; x < width; ++x) {
              hidden[x] += rise[x] / std::sqrt(1.0F + rise[x] * rise[x]);
            }
          }
          for (std::size_t x = 0; x < width; ++x) {
            open[y * width + x] = 1.0F - hidden[x] / kDirections;
          }
        }
      });
  return open;
}

std::vector<float> lamp_visibility(const SurfacePixels& pixels, double mm_per_px, double reach_mm,
                                   const Eigen::Vector3d& towards_lamp) {
  const double across = std::hypot(towards_lamp.x(), towards_lamp.y());
  std::vector<float> open(pixels.size(), 1.0F);
  if (across < 1e-6 || towards_lamp.z() <= 0) {
    return open;
  }
  const int reach = reach_px(reach_mm, mm_per_px);
  const PaddedDepth depth(pixels, reach + 1);
  const auto steps =
      steps_along(towards_lamp.x() / across, towards_lamp.y() / across, reach, 1.12, mm_per_px);
  const auto climb = static_cast<float>(towards_lamp.z() / across);
  constexpr float kPenumbra = 0.35F;  // of the tangent: a lamp some 15 degrees wide
  const Surroundings surroundings(reach, mm_per_px);
  const auto width = static_cast<std::size_t>(pixels.width);
  parallel_chunks(static_cast<std::size_t>(pixels.height), kRowGrain,
                  [&](std::size_t begin, std::size_t end) {
                    std::vector<float> over(width);
                    for (std::size_t y = begin; y < end; ++y) {
                      std::fill(over.begin(), over.end(), 0.0F);
                      const float* here = depth.row(y, 0, 0);
                      for (const Step& step : steps) {
                        const float* there = depth.row(y, step.dx, step.dy);
                        const float per_mm = 1.0F / step.distance_mm;
                        for (std::size_t x = 0; x < width; ++x) {
                          const float up = there[x] - here[x];
                          const float above = (up * per_mm - climb) * step.fade;
                          over[x] = std::max(over[x], std::min(above, kPenumbra) * surroundings.share(up));
                        }
                      }
                      for (std::size_t x = 0; x < width; ++x) {
                        const float t = over[x] / kPenumbra;
                        open[y * width + x] = 1.0F - t * t * (3.0F - 2.0F * t);
                      }
                    }
                  });
  return open;
}

std::vector<float> bending(const SurfacePixels& pixels, double mm_per_px, double scale_mm) {
  // Differences over four pixels: over two, the facets of a coarse mesh would show as a net of lines.
  constexpr int kReach = 2;
  std::vector<float> bend(pixels.size(), 0.0F);
  const auto width = static_cast<std::size_t>(pixels.width);
  const auto factor = static_cast<float>(scale_mm / (2.0 * kReach * mm_per_px));
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(0, pixels.height - 2 * kReach)),
      [&](std::size_t row) {
        for (int x = kReach; x + kReach < pixels.width; ++x) {
          const std::size_t i = (row + kReach) * width + static_cast<std::size_t>(x);
          const std::size_t up = i - kReach * width;
          const std::size_t down = i + kReach * width;
          const std::size_t left = i - kReach;
          const std::size_t right = i + kReach;
          const float covered = std::min(
              {pixels.coverage[left], pixels.coverage[right], pixels.coverage[up], pixels.coverage[down]});
          if (covered == 1.0F) {
            const float diverges = pixels.nx[right] - pixels.nx[left] + pixels.ny[up] - pixels.ny[down];
            bend[i] = std::tanh(diverges * factor);
          }
        }
      },
      16);
  return bend;
}

std::vector<float> bending_within(const SurfacePixels& pixels, double mm_per_px, double scale_mm,
                                  double radius_mm) {
  struct Spoke {
    int dx = 0, dy = 0;     ///< pixels, y downwards
    float out_x, out_y;     ///< unit, y upwards
    std::ptrdiff_t offset;  ///< in the arrays
  };
  constexpr int kSpokes = 24;
  constexpr double kTurn = 6.283185307179586;
  const double radius_px = std::clamp(radius_mm / mm_per_px, 2.0, 64.0);
  const int reach = static_cast<int>(std::ceil(radius_px)) + 1;
  const auto width = static_cast<std::size_t>(pixels.width);
  std::vector<Spoke> spokes;
  for (int k = 0; k < kSpokes; ++k) {
    const double angle = kTurn * k / kSpokes;
    const int dx = static_cast<int>(std::lround(radius_px * std::cos(angle)));
    const int dy = -static_cast<int>(std::lround(radius_px * std::sin(angle)));
    spokes.push_back({dx, dy, static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)),
                      dy * static_cast<std::ptrdiff_t>(pixels.width) + dx});
  }
  std::vector<float> bend(pixels.size(), 0.0F);
  // The flux through the ring is the divergence within it: their mean is 2 / radius times the mean outward
  // part.
  const auto factor = static_cast<float>(scale_mm * 2.0 / (radius_px * mm_per_px * kSpokes));
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(0, pixels.height - 2 * reach)),
      [&](std::size_t row) {
        for (int x = reach; x + reach < pixels.width; ++x) {
          const std::size_t i = (row + static_cast<std::size_t>(reach)) * width + static_cast<std::size_t>(x);
          float covered = 1;
          float flux = 0;
          for (const Spoke& spoke : spokes) {
            const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + spoke.offset);
            covered = std::min(covered, pixels.coverage[at]);
            flux += pixels.nx[at] * spoke.out_x + pixels.ny[at] * spoke.out_y;
          }
          if (covered == 1.0F) {
            bend[i] = std::tanh(flux * factor);
          }
        }
      },
      16);
  return bend;
}

}  // namespace dubsar
