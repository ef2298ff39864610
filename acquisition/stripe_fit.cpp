// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stripe_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace dubsar {

std::optional<double> centroid_px(CrossSection signal, double start, double half) {
  const int count = static_cast<int>(signal.size());
  double middle = start;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const double low = middle - half;
    const double high = middle + half;
    const int first = std::max(0, static_cast<int>(std::ceil(low - 0.5)));
    const int last = std::min(count - 1, static_cast<int>(std::floor(high + 0.5)));
    double mass = 0;
    double moment = 0;
    for (int i = first; i <= last; ++i) {
      double share = signal[static_cast<std::size_t>(i)];
      // Only the two ends can be cut: pixel i covers i ± 0.5.
      if (i == first || i == last) {
        share *= std::min(1.0, std::min(i + 0.5 - low, high - i + 0.5));
      }
      mass += share;
      moment += share * i;
    }
    if (!(mass > 0)) {
      return std::nullopt;
    }
    const double next = moment / mass;
    if (!(next >= 0 && next <= count - 1)) {
      return std::nullopt;
    }
    const double change = std::abs(next - middle);
    middle = next;
    if (change < 1e-3) {
      break;
    }
  }
  return middle;
}

CentreWindow::CentreWindow(double sigma_px)
    : sigma_(sigma_px), radius_(std::clamp(static_cast<int>(std::ceil(3.5 * sigma_px)), 1, kMostRadius)) {
  for (int k = 0; k <= radius_; ++k) {
    weight_[static_cast<std::size_t>(k)] = std::exp(-k * k / (2 * sigma_px * sigma_px));
  }
}

std::optional<StripeCentre> CentreWindow::centre(CrossSection signal, double start) const {
  constexpr int kRounds = 12;
  constexpr double kStays_px = 1e-3;
  const int count = static_cast<int>(signal.size());
  const double variance = sigma_ * sigma_;
  StripeCentre out{start, 0};
  for (int round = 0; round < kRounds; ++round) {
    const int nearest = static_cast<int>(std::lround(out.at_px));
    const double delta = out.at_px - nearest;
    // exp(-(k - delta)² / 2s²) is weight[k] · exp(delta / s²)^k, and a factor that all share.
    const double up = std::exp(delta / variance);
    const double down = 1 / up;
    double mass = 0, moment = 0, second = 0;
    const auto add = [&](int k, double factor) {
      const int i = nearest + k;
      if (i < 0 || i >= count) {
        return;
      }
      const double light = static_cast<double>(signal[static_cast<std::size_t>(i)]) *
                           weight_[static_cast<std::size_t>(std::abs(k))] * factor;
      const double x = k - delta;
      mass += light;
      moment += light * x;
      second += light * x * x;
    };
    add(0, 1);
    double above = 1, below = 1;
    for (int k = 1; k <= radius_; ++k) {
      above *= up;
      below *= down;
      add(k, above);
      add(-k, below);
    }
    if (!(mass > 0)) {
      return std::nullopt;
    }
    // Newton's step to where the moment vanishes; where that leads uphill, the mean's.
    const double slope = mass - second / variance;
    double step = slope > 0 ? moment / slope : moment / mass;
    step = std::clamp(step, -0.7 * sigma_, 0.7 * sigma_);
    out.at_px += step;
    out.mass = mass * std::exp(-delta * delta / (2 * variance));
    if (std::abs(out.at_px - start) > 3 * sigma_ || !(out.at_px >= 0 && out.at_px <= count - 1)) {
      return std::nullopt;
    }
    if (std::abs(step) < kStays_px) {
      break;
    }
  }
  return out;
}

std::optional<double> gaussian_px(CrossSection signal, double start, double half, double floor) {
  const int count = static_cast<int>(signal.size());
  const int first = std::max(0, static_cast<int>(std::ceil(start - half)));
  const int last = std::min(count - 1, static_cast<int>(std::floor(start + half)));
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, t0 = 0, t1 = 0, t2 = 0;
  int used = 0;
  for (int i = first; i <= last; ++i) {
    const double value = signal[static_cast<std::size_t>(i)];
    if (value <= floor) {
      continue;
    }
    const double x = i - start;
    const double w = value * value;
    const double y = std::log(value);
    const double xx = x * x;
    s0 += w;
    s1 += w * x;
    s2 += w * xx;
    s3 += w * xx * x;
    s4 += w * xx * xx;
    t0 += w * y;
    t1 += w * x * y;
    t2 += w * xx * y;
    ++used;
  }
  if (used < 3) {
    return std::nullopt;
  }
  // Cramer's rule for y = a + b x + c x²; only b/c matters.
  const double c = t2 * (s0 * s2 - s1 * s1) - t1 * (s0 * s3 - s1 * s2) + t0 * (s1 * s3 - s2 * s2);
  const double b = t1 * (s0 * s4 - s2 * s2) - t2 * (s0 * s3 - s1 * s2) - t0 * (s1 * s4 - s2 * s3);
  const double d = s0 * (s2 * s4 - s3 * s3) - s1 * (s1 * s4 - s2 * s3) + s2 * (s1 * s3 - s2 * s2);
  if (!(d > 0) || !(c < 0)) {
    return std::nullopt;
  }
  const double top = -b / (2 * c);
  return std::abs(top) <= half ? std::optional(start + top) : std::nullopt;
}

RidgeDetector::RidgeDetector(double sigma_px)
    : radius_(std::clamp(static_cast<int>(std::ceil(3 * sigma_px)), 1, kMostRadius)) {
  double total = 0;
  for (int i = -radius_; i <= radius_; ++i) {
    total += std::exp(-i * i / (2 * sigma_px * sigma_px));
  }
  // Scaled so that the derivatives of a line and of a parabola come out exact on the truncated mask.
  double first = 0;
  double second = 0;
  double offset = 0;
  const auto curve = [&](int i) {
    const double s2 = sigma_px * sigma_px;
    return (i * i / s2 - 1) / s2 * std::exp(-i * i / (2 * s2)) / total;
  };
  for (int i = -radius_; i <= radius_; ++i) {
    const double g = std::exp(-i * i / (2 * sigma_px * sigma_px)) / total;
    smooth_[i + radius_] = static_cast<float>(g);
    first += i * i * g;
    offset += curve(i) / (2 * radius_ + 1);
  }
  for (int i = -radius_; i <= radius_; ++i) {
    second += 0.5 * i * i * (curve(i) - offset);
  }
  for (int i = -radius_; i <= radius_; ++i) {
    slope_[i + radius_] = static_cast<float>(i * smooth_[i + radius_] / first);
    bend_[i + radius_] = static_cast<float>((curve(i) - offset) / second);
  }
}

std::optional<double> RidgeDetector::ridge_px(const Patch& patch) const {
  const int side = 2 * patch.radius + 1;
  const int off = patch.radius - radius_;
  float rx = 0, ry = 0, rxx = 0, rxy = 0, ryy = 0;
  for (int v = 0; v <= 2 * radius_; ++v) {
    const float* line = patch.values + (v + off) * side + off;
    float smooth = 0, slope = 0, bend = 0;
    for (int u = 0; u <= 2 * radius_; ++u) {
      smooth += smooth_[u] * line[u];
      slope += slope_[u] * line[u];
      bend += bend_[u] * line[u];
    }
    rx += smooth_[v] * slope;
    rxx += smooth_[v] * bend;
    rxy += slope_[v] * slope;
    ry += slope_[v] * smooth;
    ryy += bend_[v] * smooth;
  }
  // Across the ridge: the eigenvector of the most negative second derivative.
  const double half = 0.5 * (rxx - ryy);
  const double root = std::hypot(half, static_cast<double>(rxy));
  const double lowest = 0.5 * (rxx + ryy) - root;
  if (!(lowest < 0)) {
    return std::nullopt;
  }
  double nx = rxy;
  double ny = -half - root;  // lowest - rxx
  const double length = std::hypot(nx, ny);
  if (!(length > 1e-12)) {
    nx = 0;
    ny = 1;
  } else {
    nx /= length;
    ny /= length;
  }
  if (std::abs(ny) < 0.2) {  // runs along the column: no crossing to speak of
    return std::nullopt;
  }
  const double t = -(rx * nx + ry * ny) / lowest;
  const double crossing = t / ny;
  return std::abs(crossing) <= 1.5 ? std::optional(crossing) : std::nullopt;
}

}  // namespace dubsar
