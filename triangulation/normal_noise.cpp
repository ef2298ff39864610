// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/normal_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::array<float, 5> kFourth = {1, -4, 6, -4, 1};
const double kGain = std::sqrt(70.0);  ///< of independent noise
constexpr int kReach = 2;
/// Some ten thousand differences settle a median, and fewer than this do not.
constexpr std::size_t kMostTried = 60000;
constexpr std::size_t kLeast = 30;

/// Along the normal of the sample; nothing where one of the five is not there, or beyond a step.
std::optional<float> fourth_difference(const GridSurface& surface, std::span<const std::uint8_t> keep,
                                       int row, int col, float most_step2_mm2) {
  Vector3f sum = Vector3f::Zero();
  std::size_t before = 0;
  for (int k = -kReach; k <= kReach; ++k) {
    const std::size_t i = surface.index(row + k, col);
    if (keep[i] == 0 || surface.normals[i] == Vector3f::Zero() ||
        (k > -kReach && (surface.points[i] - surface.points[before]).squaredNorm() > most_step2_mm2)) {
      return std::nullopt;
    }
    sum += kFourth[static_cast<std::size_t>(k + kReach)] * surface.points[i];
    before = i;
  }
  return std::abs(sum.dot(surface.normals[surface.index(row, col)]));
}

}  // namespace

std::optional<double> noise_along_normal_mm(const GridSurface& surface, std::span<const std::uint8_t> keep) {
  const auto most_step_mm = static_cast<float>(3.0 * surface.spacing_mm);
  const std::size_t stride = std::max<std::size_t>(1, keep.size() / kMostTried);
  std::vector<float> differences;
  const auto width = static_cast<std::size_t>(surface.cols);
  for (std::size_t i = kReach * width; i + kReach * width < keep.size(); i += stride) {
    if (keep[i] == 0) {
      continue;
    }
    const auto difference = fourth_difference(surface, keep, static_cast<int>(i / width),
                                              static_cast<int>(i % width), most_step_mm * most_step_mm);
    if (difference) {
      differences.push_back(*difference);
    }
  }
  if (differences.size() < kLeast) {
    return std::nullopt;
  }
  return std::min(kSigmaOfMedian * static_cast<double>(median_of(std::move(differences))) / kGain,
                  0.5 * surface.spacing_mm);
}

}  // namespace dubsar
