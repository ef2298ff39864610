// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/swept_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "acquisition/stripe_line.h"
#include "core/order_statistics.h"

namespace dubsar {

namespace {

constexpr int kMostReach = 12;
// In standard deviations of the sheet:
constexpr double kReach = 2.5;      // what is looked at
constexpr double kFarthest = 1.6;   // between two rows: farther apart, a Gaussian's middle is guesswork
constexpr double kMostShift = 1.5;  // more is another surface
// In grey values: less is no light, and from where the logarithm of a pixel is one of light, not of noise.
constexpr double kLeastLight = 2;
constexpr double kLogFrom = 3;
constexpr double kLeastShare = 0.05;  // of the brightest row's light
constexpr double kOneColumn = 0.1;    // of a column's width: so near to one, that one is enough
// Between two columns the correction changes by less, unless an edge lies there.
constexpr double kEdgePx = 0.3;
// Noise of a single picture's middle, in widths of the stripe: up to the first the sweep is believed wholly,
// from the second on not at all. Half and twice the second do worse on written clay under speckle.
constexpr double kSteady = 0.025;
constexpr double kUnsteady = 0.25;

/// Through four samples, at t between the two in the middle (E. Catmull, R. Rom, 1974).
double between(const std::array<double, 4>& s, double t) {
  return s[1] + 0.5 * t *
                    (s[2] - s[0] +
                     t * (2 * s[0] - 5 * s[1] + 4 * s[2] - s[3] + t * (3 * (s[1] - s[2]) + s[3] - s[0])));
}

/// Light of one point over its distance from the sheet's middle.
struct Sweep {
  std::array<double, 2 * kMostReach + 1> off;  ///< in standard deviations of the sheet
  std::array<double, 2 * kMostReach + 1> light;
  std::array<double, 2 * kMostReach + 1> log_light;
  std::size_t size = 0;
  std::size_t sample = 0;  ///< of the row
  Eigen::Vector3d alone;   ///< where one picture puts it
};

/// The logarithm of a Gaussian: what is called bend is -1 / (2 variance).
struct Parabola {
  double level = 0, slope = 0, bend = 0;
  [[nodiscard]] double at(double x) const { return level + x * (slope + x * bend); }
  [[nodiscard]] double top() const { return -slope / (2 * bend); }
};

/// The Gaussian through the light, `bend` given or found: weighted least squares of a parabola to the
/// logarithm, the light the weight as befits shot noise, then that of the fit. It does not matter how
/// unevenly the rows lie. Nothing when there is too little light, or no top.
std::optional<Parabola> gaussian(const Sweep& sweep, std::optional<double> bend) {
  constexpr int kRounds = 2;
  double most = 0;
  for (std::size_t k = 0; k < sweep.size; ++k) {
    most = std::max(most, sweep.light[k]);
  }
  const double floor = std::max(kLeastLight, kLeastShare * most);
  Parabola fit;
  for (int round = 0; round < kRounds; ++round) {
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, t0 = 0, t1 = 0, t2 = 0;
    int used = 0;
    for (std::size_t k = 0; k < sweep.size; ++k) {
      if (!(sweep.light[k] > floor)) {
        continue;
      }
      const double x = sweep.off[k];
      const double y = sweep.log_light[k] - bend.value_or(0) * x * x;
      const double w = round == 0 ? sweep.light[k] : std::exp(fit.at(x));
      s0 += w;
      s1 += w * x;
      s2 += w * x * x;
      s3 += w * x * x * x;
      s4 += w * x * x * x * x;
      t0 += w * y;
      t1 += w * x * y;
      t2 += w * x * x * y;
      ++used;
    }
    if (used < (bend ? 2 : 3)) {
      return std::nullopt;
    }
    if (bend) {
      const double det = s0 * s2 - s1 * s1;
      if (!(det > 1e-9 * s0 * s2)) {
        return std::nullopt;
      }
      fit = {(t0 * s2 - t1 * s1) / det, (t1 * s0 - t0 * s1) / det, *bend};
    } else {
      Eigen::Matrix3d normal;
      normal << s0, s1, s2, s1, s2, s3, s2, s3, s4;
      const Eigen::Vector3d solved = normal.ldlt().solve(Eigen::Vector3d(t0, t1, t2));
      fit = {solved[0], solved[1], solved[2]};
    }
    if (!(fit.bend < 0) || !std::isfinite(fit.top())) {
      return std::nullopt;
    }
  }
  return fit;
}

/// The sheet is as wide everywhere: the width that most sweeps of a row have. Nothing when few have any.
std::optional<double> common_bend(std::span<const Sweep> sweeps) {
  constexpr std::size_t kFewest = 32;
  std::vector<double> bends;
  for (const Sweep& sweep : sweeps) {
    if (const auto fit = gaussian(sweep, std::nullopt)) {
      bends.push_back(fit->bend);
    }
  }
  if (bends.size() < kFewest) {
    return std::nullopt;
  }
  return median_of(std::move(bends));
}

}  // namespace

SweptLight::SweptLight(const Triangulator& triangulator, double sigma_px)
    : triangulator_(triangulator), sigma_px_(sigma_px) {
  const RigCalibration& rig = triangulator.calibration();
  const double reach =
      rig.laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()).value_or(rig.working_distance_mm);
  const Eigen::Vector3d one_px = triangulator.axis() == StripeAxis::kPerColumn
                                     ? Eigen::Vector3d(0, reach / rig.camera.fy_px, 0)
                                     : Eigen::Vector3d(reach / rig.camera.fx_px, 0, 0);
  sigma_mm_ = sigma_px * std::abs(rig.laser.normal.dot(one_px));
}

double SweptLight::sheet_step_mm(double from, double to) const {
  const RigCalibration& rig = triangulator_.calibration();
  const Eigen::Vector3d middle(0, 0, rig.working_distance_mm);
  const auto sheet = [&](double position) {
    return transformed(rig.motion.zero_from_camera(position), rig.motion.laser_at(rig.laser, position));
  };
  return std::abs(sheet(to).signed_distance_mm(middle) - sheet(from).signed_distance_mm(middle));
}

int SweptLight::reach(double step) const {
  const double step_mm = sheet_step_mm(0, step);
  if (!(step_mm > 0) || step_mm > kFarthest * sigma_mm_) {
    return 0;
  }
  return std::clamp(static_cast<int>(std::lround(kReach * sigma_mm_ / step_mm)), 1, kMostReach);
}

double SweptLight::light_at(const StripeLight& light, const Eigen::Vector2d& pixel) const {
  const bool per_column = triangulator_.axis() == StripeAxis::kPerColumn;
  const double across = per_column ? pixel.x() : pixel.y();
  const double along = per_column ? pixel.y() : pixel.x();
  const double left = std::floor(across);
  const double below = std::floor(along);
  const auto column = [&](double u) {
    if (!(u >= 0 && u < static_cast<double>(light.from.size()))) {
      return 0.0;
    }
    const auto at = static_cast<std::size_t>(u);
    const int first = static_cast<int>(below) - 1 - light.from[at];
    std::array<double, 4> four{};
    for (int k = 0; k < 4; ++k) {
      if (first + k >= 0 && first + k < light.rows) {
        four[static_cast<std::size_t>(k)] = static_cast<double>(
            light.grey[at * static_cast<std::size_t>(light.rows) + static_cast<std::size_t>(first + k)]);
      }
    }
    // The logarithm of a stripe is a parabola, which a cubic follows exactly.
    if (std::ranges::all_of(four, [](double grey) { return grey >= kLogFrom; })) {
      std::ranges::transform(four, four.begin(), [](double grey) { return std::log(grey); });
      return std::exp(between(four, along - below));
    }
    return between(four, along - below);
  };
  const double t = across - left;
  if (t < kOneColumn || t > 1 - kOneColumn) {
    return column(std::round(across));
  }
  return (1 - t) * column(left) + t * column(left + 1);
}

void SweptLight::correct(std::span<const SweptRow* const> rows, std::size_t middle,
                         TriangulatedProfile& out) const {
  const SweptRow& here = *rows[middle];
  const double noise = here.stripe.noise_px / sigma_px_;
  const double belief = 1 - std::clamp((noise - kSteady) / (kUnsteady - kSteady), 0.0, 1.0);
  if (middle == 0 || middle + 1 >= rows.size() || rows.size() > 2 * kMostReach + 1 || !(belief > 0)) {
    return;
  }
  for (const std::size_t beside : {middle - 1, middle + 1}) {
    if (!(sheet_step_mm(here.position, rows[beside]->position) <= kFarthest * sigma_mm_)) {
      return;
    }
  }
  const RigCalibration& rig = triangulator_.calibration();
  const RigidTransform zero_from_here = rig.motion.zero_from_camera(here.position);
  const RigidTransform here_from_zero = zero_from_here.inverse();
  std::vector<Neighbour> seen;
  std::size_t farthest = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double position = rows[k]->position;
    const RigidTransform here_from_there = here_from_zero * rig.motion.zero_from_camera(position);
    seen.push_back({&rows[k]->stripe.light,
                    transformed(here_from_there, rig.motion.laser_at(rig.laser, position)),
                    position - here.position});
    farthest = std::abs(seen[k].moved) > std::abs(seen[farthest].moved) ? k : farthest;
  }
  const RigidTransform far_from_here =
      rig.motion.zero_from_camera(rows[farthest]->position).inverse() * zero_from_here;
  const RigidTransform zero_scanner_from_here = rig.scanner_from_camera() * zero_from_here;
  std::vector<Sweep> sweeps;
  sweeps.reserve(out.valid.size());
  for (std::size_t i = 0; i < out.valid.size() && i < here.stripe.at_px.size(); ++i) {
    const auto along = static_cast<double>(here.stripe.at_px[i]);
    const auto across = static_cast<double>(i);
    const auto alone = out.valid[i] != 0
                           ? triangulator_.point_mm(static_cast<int>(i), along, seen[middle].sheet)
                           : std::nullopt;
    if (!alone) {
      continue;
    }
    const Eigen::Vector2d pixel = triangulator_.axis() == StripeAxis::kPerColumn
                                      ? Eigen::Vector2d(across, along)
                                      : Eigen::Vector2d(along, across);
    // Within so little of the way a point goes straight through the picture.
    const Eigen::Vector2d drift = (rig.camera.project(far_from_here * *alone) - pixel) / seen[farthest].moved;
    Sweep& sweep = sweeps.emplace_back();
    sweep.size = seen.size();
    sweep.sample = i;
    sweep.alone = *alone;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      sweep.off[k] = seen[k].sheet.signed_distance_mm(*alone) / sigma_mm_;
      sweep.light[k] = light_at(*seen[k].light, pixel + seen[k].moved * drift);
      sweep.log_light[k] = std::log(std::max(sweep.light[k], 1e-3));
    }
  }
  const std::optional<double> bend = common_bend(sweeps);
  if (!bend) {
    return;
  }
  StripeLine tops;
  tops.at_px.assign(out.valid.size(), StripeLine::kNone);
  tops.mass.assign(out.valid.size(), 0.0F);
  for (const Sweep& sweep : sweeps) {
    const std::optional<Parabola> fit = gaussian(sweep, bend);
    if (fit && std::abs(fit->top()) <= kMostShift) {
      tops.at_px[sweep.sample] = static_cast<float>(fit->top() * sigma_px_);
      tops.mass[sweep.sample] = static_cast<float>(std::exp(fit->at(fit->top())));
    }
  }
  std::vector<float> settled(tops.at_px.size());
  const double unsteady_px = line_noise_px(tops);
  average_along(tops, averaging_width_px(unsteady_px), kEdgePx, settled);
  for (const Sweep& sweep : sweeps) {
    const auto top_px = static_cast<double>(settled[sweep.sample]);
    if (std::isnan(top_px)) {
      continue;
    }
    // What is no larger than the noise is noise.
    const double signal = top_px * top_px / (top_px * top_px + unsteady_px * unsteady_px);
    const double top = signal * top_px / sigma_px_;
    const Eigen::Vector3d sight = sweep.alone.normalized();
    const Eigen::Vector3d moved =
        sweep.alone - belief * top * sigma_mm_ / seen[middle].sheet.normal.dot(sight) * sight;
    const Eigen::Vector3d p = zero_scanner_from_here * moved;
    out.x[sweep.sample] = static_cast<float>(p.x());
    out.y[sweep.sample] = static_cast<float>(p.y());
    out.z[sweep.sample] = static_cast<float>(p.z());
  }
}

}  // namespace dubsar
