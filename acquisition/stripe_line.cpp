// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Local linear regression with a kernel (W. S. Cleveland, Robust locally weighted regression and smoothing
// scatterplots, J. Am. Stat. Assoc. 74, 1979; J. Fan, I. Gijbels, Local Polynomial Modelling and Its
// Applications, 1996, 3.2 for the width). Weighting by light: the brighter a speckle, the surer its place.
#include "acquisition/stripe_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

constexpr std::size_t kFewest = 32;  // columns that tell the noise
constexpr double kWidest_px = 2.5;   // of the average
constexpr double kNarrowest_px = 0.3;
constexpr double kReach = 2.5;  // widths that are looked at
constexpr std::size_t kMostReach = 7;
// How strongly the stripe bends on written clay at 25 µm a pixel, px per column squared: between the values
// that do best on blank and on written tablets, with 0.05 and 0.1 within 4 % of it (dubsar-frames).
constexpr double kBend = 0.08;

double median_difference(const std::vector<float>& at, std::size_t lag, std::vector<float>& scratch) {
  scratch.clear();
  for (std::size_t u = lag; u + lag < at.size(); ++u) {
    const float difference = at[u - lag] - 2 * at[u] + at[u + lag];
    if (!std::isnan(difference)) {
      scratch.push_back(std::abs(difference));
    }
  }
  if (scratch.size() < kFewest) {
    return 0;
  }
  return static_cast<double>(value_at_rank(scratch, scratch.size() / 2));
}

}  // namespace

double line_noise_px(const StripeLine& line) {
  // a - 2 b + c has √6 times the standard deviation of each.
  constexpr double kSigma = kSigmaOfMedian / 2.449489743;
  std::vector<float> scratch;
  scratch.reserve(line.at_px.size());
  return kSigma *
         std::max(median_difference(line.at_px, 1, scratch), median_difference(line.at_px, 2, scratch));
}

double averaging_width_px(double noise_px) {
  // Least of (bend · w² / 2)² + noise² / (2 √π w).
  const double fifth = noise_px * noise_px / (2 * std::sqrt(std::numbers::pi) * kBend * kBend);
  return std::clamp(std::pow(fifth, 0.2), kNarrowest_px, kWidest_px);
}

void average_along(const StripeLine& line, double width_px, double largest_step_px, std::span<float> out) {
  const auto count = static_cast<std::ptrdiff_t>(line.at_px.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(kReach * width_px));
  std::array<double, kMostReach + 1> kernel{};
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    kernel[k] = std::exp(-static_cast<double>(k * k) / (2 * width_px * width_px));
  }
  const std::ptrdiff_t last = std::min(reach, static_cast<std::ptrdiff_t>(kMostReach));
  for (std::ptrdiff_t u = 0; u < count; ++u) {
    const auto here = static_cast<std::size_t>(u);
    const auto at = static_cast<double>(line.at_px[here]);
    if (std::isnan(at)) {
      out[here] = StripeLine::kNone;
      continue;
    }
    auto s0 = static_cast<double>(line.mass[here]);
    double s1 = 0, s2 = 0, t0 = 0, t1 = 0;
    for (const std::ptrdiff_t way : {-1, 1}) {
      double before = at;
      for (std::ptrdiff_t k = 1; k <= last; ++k) {
        const std::ptrdiff_t there = u + way * k;
        if (there < 0 || there >= count) {
          break;
        }
        const auto next = static_cast<double>(line.at_px[static_cast<std::size_t>(there)]);
        if (!(std::abs(next - before) <= largest_step_px)) {
          break;
        }
        before = next;
        const double w = kernel[static_cast<std::size_t>(k)] *
                         static_cast<double>(line.mass[static_cast<std::size_t>(there)]);
        const auto x = static_cast<double>(way * k);
        s0 += w;
        s1 += w * x;
        s2 += w * x * x;
        t0 += w * (next - at);
        t1 += w * x * (next - at);
      }
    }
    const double det = s0 * s2 - s1 * s1;
    const bool lonely = !(det > 1e-9 * s0 * s2);
    out[here] = static_cast<float>(lonely ? at : at + (t0 * s2 - t1 * s1) / det);
  }
}

}  // namespace dubsar
