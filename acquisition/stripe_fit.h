// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <optional>
#include <span>

namespace dubsar {

/// Signal across the stripe, background taken off; sample i lies at i px.
using CrossSection = std::span<const float>;

/// Centre of mass within `half` px of `start`, moved along until it stays. Pixels that the window cuts count
/// by the part that is inside. Nothing when there is no light.
[[nodiscard]] std::optional<double> centroid_px(CrossSection signal, double start, double half);

/// Where a stripe is, and on how much light that rests.
struct StripeCentre {
  double at_px = 0;
  double mass = 0;
};

/// Centre of mass under a Gaussian window that moves along until it stays: the top of the cross section
/// smoothed by that Gaussian. What lies far off the middle counts little, so that neither a wall beside the
/// stripe nor what is left of the background pulls at it; the narrower the window, the less it averages over
/// the speckles within the stripe.
class CentreWindow {
 public:
  explicit CentreWindow(double sigma_px);
  [[nodiscard]] double sigma_px() const { return sigma_; }
  /// Nothing when there is no light, or no top within three sigmas of `start`.
  [[nodiscard]] std::optional<StripeCentre> centre(CrossSection signal, double start) const;

 private:
  static constexpr int kMostRadius = 24;
  double sigma_;
  int radius_;
  std::array<double, kMostRadius + 1> weight_{};
};

/// Middle of a Gaussian: least squares of a parabola to the logarithm with the squared signal as weight
/// (H. Guo, A simple algorithm for fitting a Gaussian function, IEEE Signal Processing Magazine 28(5), 2011).
/// Pixels below `floor` are left out. Nothing when the parabola opens upwards or its top is outside.
[[nodiscard]] std::optional<double> gaussian_px(CrossSection signal, double start, double half, double floor);

/// A square patch around a pixel, row major, side = 2·radius + 1.
struct Patch {
  const float* values = nullptr;
  int radius = 0;
};

/// Where the ridge through the patch crosses its middle column, px below the middle (C. Steger, An unbiased
/// detector of curvilinear structures, IEEE PAMI 20(2), 1998): derivatives of the image smoothed by a
/// Gaussian, top of its second-order expansion across the ridge. Nothing when there is no ridge within a
/// pixel.
class RidgeDetector {
 public:
  static constexpr int kMostRadius = 12;
  static constexpr int kMostSide = 2 * kMostRadius + 1;
  explicit RidgeDetector(double sigma_px);
  [[nodiscard]] int radius() const { return radius_; }
  [[nodiscard]] std::optional<double> ridge_px(const Patch& patch) const;

 private:
  int radius_;
  float smooth_[kMostSide]{};
  float slope_[kMostSide]{};
  float bend_[kMostSide]{};
};

}  // namespace dubsar
