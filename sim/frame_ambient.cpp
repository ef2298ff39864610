// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The part of a frame that is there without the laser: room light on the target, blurred by the lens.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "sim/frame_renderer.h"

namespace dubsar::sim {

namespace {

constexpr double kAlbedo = 0.5;
constexpr int kCoarse = 4;  // px between the rays where the albedo is smooth

/// A light that is everywhere, a little stronger from above the camera.
double shade(const SceneHit& hit) {
  const Eigen::Vector3d from = Eigen::Vector3d(-0.2, -0.5, -1).normalized();
  return (hit.albedo / kAlbedo) * (0.4 + 0.6 * std::max(0.0, from.dot(hit.normal)));
}

/// Blurs along rows, then along columns, by a Gaussian of sigma px.
void blur(std::vector<float>& image, int width, int height, double sigma) {
  constexpr int kReach = 4;
  std::array<float, 2 * kReach + 1> taps{};
  float total = 0;
  for (int i = -kReach; i <= kReach; ++i) {
    taps[static_cast<std::size_t>(i + kReach)] = static_cast<float>(std::exp(-i * i / (2 * sigma * sigma)));
    total += taps[static_cast<std::size_t>(i + kReach)];
  }
  std::vector<float> out(image.size());
  const auto pass = [&](int along, int across, std::size_t step_along, std::size_t step_across) {
    parallel_for_each_index(
        static_cast<std::size_t>(across),
        [&](std::size_t line) {
          for (int i = 0; i < along; ++i) {
            float sum = 0;
            for (int k = -kReach; k <= kReach; ++k) {
              const auto at = static_cast<std::size_t>(std::clamp(i + k, 0, along - 1));
              sum += taps[static_cast<std::size_t>(k + kReach)] * image[line * step_across + at * step_along];
            }
            out[line * step_across + static_cast<std::size_t>(i) * step_along] = sum / total;
          }
        },
        16);
    image.swap(out);
  };
  pass(width, height, 1, static_cast<std::size_t>(width));
  pass(height, width, static_cast<std::size_t>(width), 1);
}

}  // namespace

std::vector<float> FrameRenderer::ambient(const FrameTarget& target) const {
  const int width = truth_.camera.width;
  const int height = truth_.camera.height;
  const auto columns = static_cast<std::size_t>(width);
  std::vector<float> out(columns * static_cast<std::size_t>(height), 0.0F);
  const auto light_along = [&](const Eigen::Vector3d& ray) {
    const std::optional<SceneHit> hit = target.hit(Eigen::Vector3d::Zero(), ray);
    return hit ? static_cast<float>(options_.ambient_signal * shade(*hit)) : 0.0F;
  };
  const auto light_at = [&](double u, double v) { return light_along(ray_through(u, v)); };
  const int samples = target.samples_per_px();
  if (samples > 1) {
    // Undoing the distortion is what takes time: it is done at the pixels' corners, between which rays are
    // linear to a millionth of a pixel.
    parallel_for_each_index(
        static_cast<std::size_t>(height),
        [&](std::size_t row) {
          std::array<std::vector<Eigen::Vector3d>, 2> edge;
          for (int side = 0; side < 2; ++side) {
            for (int u = 0; u <= width; ++u) {
              const Eigen::Vector3d ray = ray_through(u - 0.5, static_cast<double>(row) - 0.5 + side);
              edge[static_cast<std::size_t>(side)].push_back(ray / ray.z());
            }
          }
          for (std::size_t u = 0; u < columns; ++u) {
            float sum = 0;
            for (int k = 0; k < samples * samples; ++k) {
              const double s = (k % samples + 0.5) / samples;
              const double t = (k / samples + 0.5) / samples;
              const Eigen::Vector3d ray = (1 - t) * ((1 - s) * edge[0][u] + s * edge[0][u + 1]) +
                                          t * ((1 - s) * edge[1][u] + s * edge[1][u + 1]);
              sum += light_along(ray.normalized());
            }
            out[row * columns + u] = sum / static_cast<float>(samples * samples);
          }
        },
        4);
    blur(out, width, height, std::max(0.2, spread_.sigma() / 2));  // two samples of the spread per pixel
    return out;
  }
  const int nodes_u = (width + kCoarse - 1) / kCoarse + 1;
  const int nodes_v = (height + kCoarse - 1) / kCoarse + 1;
  std::vector<float> nodes(static_cast<std::size_t>(nodes_u) * static_cast<std::size_t>(nodes_v));
  parallel_for_each_index(nodes.size(), [&](std::size_t i) {
    const auto across = static_cast<std::size_t>(nodes_u);
    nodes[i] = light_at(static_cast<double>(i % across) * kCoarse, static_cast<double>(i / across) * kCoarse);
  });
  parallel_for_each_index(
      static_cast<std::size_t>(height),
      [&](std::size_t row) {
        const auto v = static_cast<int>(row);
        const float tv = static_cast<float>(v % kCoarse) / kCoarse;
        const float* above = nodes.data() + static_cast<std::ptrdiff_t>(v / kCoarse) * nodes_u;
        const float* below = above + nodes_u;
        for (int u = 0; u < width; ++u) {
          const float tu = static_cast<float>(u % kCoarse) / kCoarse;
          const int n = u / kCoarse;
          out[row * columns + static_cast<std::size_t>(u)] =
              (1 - tv) * ((1 - tu) * above[n] + tu * above[n + 1]) +
              tv * ((1 - tu) * below[n] + tu * below[n + 1]);
        }
      },
      8);
  return out;
}

}  // namespace dubsar::sim
