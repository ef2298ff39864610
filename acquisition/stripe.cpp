// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stripe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "acquisition/stripe_fit.h"

namespace dubsar {

namespace {

constexpr int kBlock = 16;  // rows whose maximum is kept
// The window of the adaptive detector, shares of the stripe's own width: narrow where a column's middle is
// steadier than the first share of that width, wide where it is less steady than the last. What does best on
// simulated clay from f/5.6 to f/11 (dubsar-frames).
constexpr double kNarrow = 0.83;
constexpr double kWide = 1.67;
constexpr double kSteady = 0.025;
constexpr double kUnsteady = 0.125;
// Between two columns the stripe climbs less than this on clay that one can see; more is an edge.
constexpr double kStepPx = 2;

GrayImage transposed(const GrayView& image) {
  constexpr int kTile = 32;
  GrayImage out(image.height, image.width);
  for (int v0 = 0; v0 < image.height; v0 += kTile) {
    for (int u0 = 0; u0 < image.width; u0 += kTile) {
      for (int v = v0; v < std::min(image.height, v0 + kTile); ++v) {
        const std::uint8_t* line = image.row(v);
        for (int u = u0; u < std::min(image.width, u0 + kTile); ++u) {
          out.pixels[out.index(v, u)] = line[u];
        }
      }
    }
  }
  return out;
}

int over_background(const GrayView& on, const GrayView& off, int u, int v) {
  return on.row(v)[u] - (off.empty() ? 0 : off.row(v)[u]);
}

/// The middle of the brightest three rows together, which one hot pixel does not win.
int brightest_row(CrossSection light) {
  std::size_t top = 0;
  float most = -1;
  for (std::size_t k = 1; k + 1 < light.size(); ++k) {
    const float three = light[k - 1] + 2 * light[k] + light[k + 1];
    if (three > most) {
      most = three;
      top = k;
    }
  }
  return static_cast<int>(top);
}

/// From the first row that is as bright to the last.
double rows_above(CrossSection light, float level) {
  const auto bright = [level](float value) { return value >= level; };
  const auto first = std::ranges::find_if(light, bright);
  const auto last = std::find_if(light.rbegin(), std::make_reverse_iterator(first), bright);
  return static_cast<double>(last.base() - first);
}

}  // namespace

Status StripeOptions::check() const {
  if (!(sigma_px >= 0.3 && sigma_px <= 6)) {
    return fail(ErrorKind::kUsage, "the stripe's width is from 0.3 to 6 px (standard deviation)");
  }
  if (least_peak < 1 || least_peak > 254 || saturated_from < 2 || most_saturated_px < 0 ||
      !(second_share > 0 && second_share <= 1) || !(widest > 1)) {
    return fail(ErrorKind::kUsage, "a limit of the stripe detector makes no sense");
  }
  return {};
}

void StripeProfile::resize(std::size_t count) {
  at_px.assign(count, 0.0F);
  peak.assign(count, 0.0F);
  confidence.assign(count, 0.0F);
  state.assign(count, StripeState::kNone);
  noise_px = 0;
  light = {};
}

std::size_t StripeProfile::count_of(StripeState which) const {
  return static_cast<std::size_t>(std::count(state.begin(), state.end(), which));
}

void StripeExtractor::extract(const GrayView& on_given, const GrayView& off_given, StripeProfile& profile) {
  GrayView on = on_given;
  GrayView off = off_given;
  if (on.empty() || (!off.empty() && !off.same_size(on))) {
    profile.resize(0);
    return;
  }
  if (options_.axis == StripeAxis::kPerRow) {
    turned_on_ = transposed(on);
    on = turned_on_.view();
    if (!off.empty()) {
      turned_off_ = transposed(off);
      off = turned_off_.view();
    }
  }
  const auto width = static_cast<std::size_t>(on.width);
  profile.resize(width);
  cuts_.resize(width);
  for (Cut& cut : cuts_) {
    cut.size = 0;
  }
  line_.at_px.assign(width, StripeLine::kNone);
  line_.mass.assign(width, 0.0F);
  find_peaks(on, off);
  for (int u = 0; u < on.width; ++u) {
    refine(on, off, u, profile);
  }
  if (options_.keep_light) {
    keep_light(profile);
  }
  if (options_.method == StripeMethod::kAdaptive) {
    settle(profile);
  }
}

void StripeExtractor::keep_light(StripeProfile& profile) const {
  StripeLight& light = profile.light;
  light.rows = 0;
  for (const Cut& cut : cuts_) {
    light.rows = std::max(light.rows, cut.size);
  }
  const auto rows = static_cast<std::size_t>(light.rows);
  light.from.resize(cuts_.size());
  light.grey.assign(cuts_.size() * rows, 0.0F);
  for (std::size_t u = 0; u < cuts_.size(); ++u) {
    light.from[u] = cuts_[u].low;
    std::copy_n(cuts_[u].light.begin(), cuts_[u].size,
                light.grey.begin() + static_cast<std::ptrdiff_t>(u * rows));
  }
}

void StripeExtractor::settle(StripeProfile& profile) {
  const double noise = line_noise_px(line_);
  profile.noise_px = noise;
  const double unsteady = std::clamp((noise / options_.sigma_px - kSteady) / (kUnsteady - kSteady), 0.0, 1.0);
  const CentreWindow window(options_.sigma_px * std::lerp(kNarrow, kWide, unsteady));
  for (std::size_t u = 0; u < cuts_.size(); ++u) {
    if (profile.state[u] != StripeState::kGood) {
      continue;
    }
    const Cut& cut = cuts_[u];
    const CrossSection signal(cut.light.data(), static_cast<std::size_t>(cut.size));
    if (const auto centre =
            window.centre(signal, static_cast<double>(line_.at_px[u]) - static_cast<double>(cut.low))) {
      line_.at_px[u] = static_cast<float>(cut.low + centre->at_px);
      line_.mass[u] = static_cast<float>(centre->mass);
    }
  }
  average_along(line_, averaging_width_px(noise), kStepPx + 4 * noise, profile.at_px);
}

void StripeExtractor::find_peaks(const GrayView& on, const GrayView& off) {
  const auto width = static_cast<std::size_t>(on.width);
  blocks_ = (on.height + kBlock - 1) / kBlock;
  block_peak_.assign(static_cast<std::size_t>(blocks_) * width, 0);
  best_.assign(width, 0);
  second_.assign(width, 0);
  best_block_.assign(width, 0);
  for (int block = 0; block < blocks_; ++block) {
    std::uint8_t* const peak = block_peak_.data() + static_cast<std::size_t>(block) * width;
    const int end = std::min(on.height, (block + 1) * kBlock);
    for (int v = block * kBlock; v < end; ++v) {
      const std::uint8_t* const line = on.row(v);
      if (off.empty()) {
        for (std::size_t u = 0; u < width; ++u) {
          peak[u] = std::max(peak[u], line[u]);
        }
      } else {
        const std::uint8_t* const dark = off.row(v);
        for (std::size_t u = 0; u < width; ++u) {
          const auto signal = static_cast<std::uint8_t>(std::max(line[u], dark[u]) - dark[u]);
          peak[u] = std::max(peak[u], signal);
        }
      }
    }
  }
  for (int block = 0; block < blocks_; ++block) {
    const std::uint8_t* const peak = block_peak_.data() + static_cast<std::size_t>(block) * width;
    const auto number = static_cast<std::uint16_t>(block);
    for (std::size_t u = 0; u < width; ++u) {
      best_block_[u] = peak[u] > best_[u] ? number : best_block_[u];
      best_[u] = std::max(best_[u], peak[u]);
    }
  }
  for (int block = 0; block < blocks_; ++block) {
    const std::uint8_t* const peak = block_peak_.data() + static_cast<std::size_t>(block) * width;
    const auto number = static_cast<std::uint16_t>(block);
    for (std::size_t u = 0; u < width; ++u) {
      const int apart = std::max(number, best_block_[u]) - std::min(number, best_block_[u]);
      const std::uint8_t other = apart > 1 ? peak[u] : std::uint8_t{0};
      second_[u] = std::max(second_[u], other);
    }
  }
}

std::optional<double> StripeExtractor::ridge_row(const GrayView& on, const GrayView& off, int column,
                                                 double start) const {
  const int r = ridge_.radius();
  std::array<float, RidgeDetector::kMostSide * RidgeDetector::kMostSide> values{};
  int v = static_cast<int>(std::lround(start));
  std::optional<double> crossing;
  for (int round = 0; round < 2; ++round) {
    for (int dv = -r; dv <= r; ++dv) {
      const int vv = std::clamp(v + dv, 0, on.height - 1);
      for (int du = -r; du <= r; ++du) {
        const int uu = std::clamp(column + du, 0, on.width - 1);
        values[static_cast<std::size_t>((dv + r) * (2 * r + 1) + du + r)] =
            static_cast<float>(over_background(on, off, uu, vv));
      }
    }
    crossing = ridge_.ridge_px({values.data(), r});
    if (!crossing) {
      return std::nullopt;
    }
    if (std::abs(*crossing) <= 0.6 || round == 1) {
      break;
    }
    v = std::clamp(v + static_cast<int>(std::lround(*crossing)), 0, on.height - 1);
  }
  return v + *crossing;
}

StripeExtractor::CutLight StripeExtractor::take_cut(const GrayView& on, const GrayView& off, int column,
                                                    int row, int reach, Cut& cut) const {
  cut.low = std::max(0, row - reach);
  const int high = std::min(on.height - 1, row + reach);
  cut.size = high - cut.low + 1;
  CutLight is;
  for (int v = cut.low; v <= high; ++v) {
    cut.light[static_cast<std::size_t>(v - cut.low)] =
        static_cast<float>(over_background(on, off, column, v));
    is.saturated += on.row(v)[column] >= options_.saturated_from ? 1 : 0;
  }
  const std::span<float> light(cut.light.data(), static_cast<std::size_t>(cut.size));
  if (light.size() >= 8) {
    const auto mean3 = [&](std::size_t from) {
      return (light[from] + light[from + 1] + light[from + 2]) / 3;
    };
    const float ends = std::min(mean3(0), mean3(light.size() - 3));
    is.ground = off.empty() ? ends : std::clamp(ends, -2.0F, 2.0F);
  }
  for (float& value : light) {
    value -= is.ground;
    is.peak = std::max(is.peak, value);
  }
  return is;
}

void StripeExtractor::refine(const GrayView& on, const GrayView& off, int column, StripeProfile& profile) {
  const auto i = static_cast<std::size_t>(column);
  if (best_[i] < options_.least_peak) {
    return;
  }
  const int first = std::max(0, (best_block_[i] - 1) * kBlock);
  const int last = std::min(on.height, (best_block_[i] + 2) * kBlock);
  std::array<float, 3 * kBlock> strip{};
  const int length = last - first;
  for (int k = 0; k < length; ++k) {
    strip[static_cast<std::size_t>(k)] = static_cast<float>(over_background(on, off, column, first + k));
  }
  const int top = brightest_row({strip.data(), static_cast<std::size_t>(length)});
  const double half = std::min<double>(kMostHalf - 4, 3 * options_.sigma_px);
  const int window = static_cast<int>(std::ceil(half));
  Cut& cut = cuts_[i];
  const auto [saturated, ground, peak] = take_cut(on, off, column, first + top, window + 3, cut);
  const CrossSection signal(cut.light.data(), static_cast<std::size_t>(cut.size));
  profile.peak[i] = std::clamp(peak / 255.0F, 0.0F, 1.0F);
  if (peak < static_cast<float>(options_.least_peak)) {
    return;
  }
  if (saturated > options_.most_saturated_px) {
    profile.state[i] = StripeState::kSaturated;
    return;
  }
  // Another peak: in the strip outside the window, or far away in the column.
  float other = static_cast<float>(second_[i]) - std::max(0.0F, ground);
  for (int k = 0; k < length; ++k) {
    if (std::abs(k - top) > window + 1) {
      other = std::max(other, strip[static_cast<std::size_t>(k)] - ground);
    }
  }
  if (other > static_cast<float>(options_.second_share) * peak &&
      other >= static_cast<float>(options_.least_peak)) {
    profile.state[i] = StripeState::kReflection;
    return;
  }
  const double start = first + top - cut.low;
  std::optional<double> at = centroid_px(signal, start, half);
  if (at) {
    constexpr double kHalfHeight = 2.355;  // full width there over the standard deviation of a Gaussian
    if (rows_above(signal, 0.5F * peak) > options_.widest * kHalfHeight * options_.sigma_px) {
      profile.state[i] = StripeState::kWide;  // smeared
      return;
    }
    if (options_.method == StripeMethod::kAdaptive) {
      const std::optional<StripeCentre> centre = window_.centre(signal, *at);
      at = centre ? std::optional(centre->at_px) : std::nullopt;
      line_.mass[i] = centre ? static_cast<float>(centre->mass) : 0.0F;
    } else if (options_.method == StripeMethod::kGaussian) {
      at = gaussian_px(signal, *at, half, std::max(2.0, 0.1 * peak));
    } else if (options_.method == StripeMethod::kSteger) {
      const std::optional<double> row = ridge_row(on, off, column, cut.low + *at);
      at = row ? std::optional(*row - cut.low) : std::nullopt;
    }
  }
  if (!at) {
    profile.state[i] = StripeState::kWide;
    return;
  }
  profile.state[i] = StripeState::kGood;
  profile.at_px[i] = static_cast<float>(cut.low + *at);
  line_.at_px[i] = profile.at_px[i];
  const float bright = std::min(1.0F, peak / (4.0F * static_cast<float>(options_.least_peak)));
  const float clipped = 1.0F - 0.15F * static_cast<float>(saturated);
  const float alone = 1.0F - std::max(0.0F, other) / peak;
  profile.confidence[i] = std::clamp(bright * clipped * alone, 0.01F, 1.0F);
}

}  // namespace dubsar
