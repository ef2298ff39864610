// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/field_colours.h"

#include <algorithm>
#include <cmath>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb kPale{240, 236, 226};
constexpr Rgb kDark{34, 36, 48};
constexpr Rgb kClay{208, 176, 138};
constexpr Rgb kBlue{24, 62, 142};
constexpr Rgb kRed{178, 32, 36};
constexpr Rgb kUnknown{128, 128, 128};
constexpr float kCurvatureRangePerMm = 3.0F;
constexpr float kLeastHeightRangeMm = 0.05F;
constexpr std::size_t kGrain = 1U << 14U;

Rgb blend(const Rgb& a, const Rgb& b, float t) {
  Rgb mixed{};
  for (std::size_t i = 0; i < 3; ++i) {
    mixed[i] = static_cast<std::uint8_t>(
        std::lround(static_cast<float>(a[i]) + t * (static_cast<float>(b[i]) - static_cast<float>(a[i]))));
  }
  return mixed;
}

template <class Colour>
std::vector<Rgb> colours_of(std::size_t count, const Colour& colour) {
  std::vector<Rgb> colours(count);
  parallel_for_each_index(
      count, [&](std::size_t i) { colours[i] = colour(i); }, kGrain);
  return colours;
}

std::vector<Rgb> ramp(const std::vector<float>& values) {
  return colours_of(values.size(), [&](std::size_t i) {
    return std::isfinite(values[i]) ? blend(kDark, kPale, std::clamp(values[i], 0.0F, 1.0F)) : kUnknown;
  });
}

/// The depth that one vertex in a hundred lies below.
float deep_mm(std::vector<float> heights) {
  if (heights.empty()) {
    return kLeastHeightRangeMm;
  }
  return std::max(kLeastHeightRangeMm, -value_at_rank(heights, heights.size() / 100));
}

}  // namespace

std::string_view field_name(SurfaceField field) {
  switch (field) {
    case SurfaceField::kReliability:
      return "reliability";
    case SurfaceField::kMeanCurvature:
      return "curvature";
    case SurfaceField::kOpenness:
      return "openness";
    case SurfaceField::kFreeSurface:
      return "free_surface";
    case SurfaceField::kHeight:
      return "height";
  }
  return "";
}

std::vector<Rgb> diverging_colours(const std::vector<float>& values, float middle, float range) {
  return colours_of(values.size(), [&](std::size_t i) {
    if (!std::isfinite(values[i])) {
      return kUnknown;
    }
    const float t = std::clamp((values[i] - middle) / range, -1.0F, 1.0F);
    return blend(kPale, t < 0 ? kBlue : kRed, std::abs(t));
  });
}

std::vector<Rgb> field_colours(const SurfaceFields& fields, SurfaceField field) {
  switch (field) {
    case SurfaceField::kReliability:
      return ramp(fields.reliability);
    case SurfaceField::kMeanCurvature:
      return diverging_colours(fields.mean_curvature_per_mm, 0, kCurvatureRangePerMm);
    case SurfaceField::kOpenness:
      return ramp(fields.openness);
    case SurfaceField::kFreeSurface:
      return colours_of(fields.free_surface.size(),
                        [&](std::size_t i) { return fields.free_surface[i] != 0 ? kClay : kDark; });
    case SurfaceField::kHeight:
      return diverging_colours(fields.height_mm, 0, deep_mm(fields.height_mm));
  }
  return {};
}

}  // namespace dubsar
