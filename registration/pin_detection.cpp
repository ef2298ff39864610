// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_detection.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/grid_noise.h"
#include "core/parallel.h"
#include "core/units.h"
#include "registration/pin_arm.h"
#include "registration/pin_components.h"
#include "registration/pin_mask.h"
#include "registration/pin_noise.h"
#include "registration/pin_piece.h"

namespace dubsar {

namespace {

/// Residuals of a sample on a pin, in standard deviations of the noise along the ray.
constexpr double kSampleSigmas = 4.0;
/// Where a ball explains the cap so much better, nothing else is asked.
constexpr double kClearCylinderRatio = 15.0;
/// Offset of a ball from its arm's axis: what pins are bent, of the radius, and what the fit's error makes.
constexpr double kMostOffAxis = 0.08;
constexpr double kOffAxisSigmas = 4.0;
/// The smallest piece that is looked at, of the samples of a ball's disc.
constexpr double kLeastDiscs = 0.2;

/// Covariance of the ball's centre: H⁻¹ M H⁻¹ with H = Σ w n nᵀ and M = Σ w_i w_j cov(i, j) n_i n_jᵀ over the
/// samples of a row.
Eigen::Matrix3d covariance_of(const RangeGrid& grid, const PinArm& body, const RowNoise& noise) {
  const Ball& ball = *body.ball;
  std::vector<Eigen::Vector3d> pulls;
  for (const std::size_t k : ball.samples) {
    const std::uint32_t i = body.samples[k];
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    const Eigen::Vector3d n = (p - ball.center_mm).normalized();
    pulls.emplace_back(ball_weight(n, grid.view.to_camera(p, grid.row_of(i))) * n);
  }
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < pulls.size(); ++a) {
    const std::uint32_t i = body.samples[ball.samples[a]];
    for (std::size_t b = a; b < pulls.size(); ++b) {
      const std::uint32_t j = body.samples[ball.samples[b]];
      if (grid.row_of(i) != grid.row_of(j)) {
        break;
      }
      const double c = noise.at(static_cast<int>(j - i));
      m += c * pulls[a] * pulls[b].transpose();
      if (a != b) {
        m += c * pulls[b] * pulls[a].transpose();
      }
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> h(ball.normal_matrix);
  const Eigen::Matrix3d half = h.solve(m);
  const Eigen::Matrix3d covariance = h.solve(half.transpose());
  return 0.5 * (covariance + covariance.transpose());
}

/// Drops the bodies that are not settled and have pieces of other shapes near: clay that shadows cut up.
void drop_unsettled(const RangeGrid& grid, const Sheets& sheets, double near_mm, double spacing_mm,
                    std::vector<std::optional<PinArm>>& found) {
  std::vector<std::uint8_t> other(sheets.components.size(), 1);
  for (std::size_t c = 0; c < other.size(); ++c) {
    other[c] = found[c] ? 0 : 1;
  }
  parallel_for_each_index(
      found.size(),
      [&](std::size_t c) {
        if (found[c] && !found[c]->settled &&
            standing_clear(grid, sheets, other, piece_of(grid, sheets, c), near_mm, spacing_mm) < 0.9) {
          found[c].reset();
        }
      },
      4);
}

}  // namespace

PinDetection detect_pins(const RangeGrid& grid, double tip_diameter_mm, const PinDetectionOptions& options) {
  PinDetection out;
  out.mask.assign(grid.size(), 0);
  PinScale scale;
  scale.spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  scale.radius_mm = 0.5 * tip_diameter_mm;
  // Fewer than some four samples across the ball cannot tell it from anything else.
  if (!(tip_diameter_mm > 0) || !(scale.spacing_mm > 0) || tip_diameter_mm < 3.5 * scale.spacing_mm) {
    return out;
  }
  scale.noise_mm = estimate_noise_mm(grid);
  scale.disc = kPi * std::pow(scale.radius_mm / scale.spacing_mm, 2);
  scale.on_arm_mm = std::max(kSampleSigmas * scale.noise_mm, 0.1 * scale.radius_mm);
  scale.on_ball_mm = scale.on_arm_mm;
  SheetOptions parting;
  parting.spacing_mm = scale.spacing_mm;
  parting.noise_mm = scale.noise_mm;
  parting.step_factor = options.step_factor;
  const Sheets sheets = part_at_steps(grid, parting);
  const int side = static_cast<int>(options.most_width * tip_diameter_mm / scale.spacing_mm) + 1;
  std::vector<std::uint8_t> large(sheets.components.size(), 0);
  parallel_for_each_index(
      large.size(), [&](std::size_t c) { large[c] = is_thin(sheets, grid, c, side) ? 0 : 1; }, 1);
  const std::vector<std::uint8_t> clay =
      connected_with_large(sheets, grid, large, options.alone_mm, scale.spacing_mm);
  std::vector<std::optional<PinArm>> found(sheets.components.size());
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (large[c] == 0 && static_cast<double>(sheets.components[c].cells) >= kLeastDiscs * scale.disc) {
          found[c] =
              find_pin_arm(grid, sheets, large, clay[c] == 0, piece_of(grid, sheets, c), scale, options);
        }
      },
      1);
  drop_unsettled(grid, sheets, options.near_mm, scale.spacing_mm, found);
  mask_remnants(grid, sheets, clay, found, options.far_mm, scale.spacing_mm, out.mask);
  std::vector<PinArm> bodies;
  RowNoiseSums sums;
  for (std::optional<PinArm>& body : found) {
    if (body) {
      sums.add(body->noise);
      bodies.push_back(std::move(*body));
    }
  }
  const RowNoise noise = sums.noise();
  out.noise_mm = std::sqrt(noise.at(0));
  for (PinArm& body : bodies) {
    if (!body.ball) {
      continue;
    }
    const Eigen::Matrix3d covariance = covariance_of(grid, body, noise);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    if (!covariance.allFinite() || eigen.eigenvalues()[2] > std::pow(options.most_sigma_mm, 2)) {
      continue;
    }
    // A ball sits on its arm's axis, as far as its fit can tell: where its cap alone leaves a doubt.
    const double off_axis_mm = body.cone.from_axis(body.ball->center_mm);
    if (body.ball->cylinder_ratio < kClearCylinderRatio &&
        off_axis_mm > kMostOffAxis * scale.radius_mm + kOffAxisSigmas * std::sqrt(eigen.eigenvalues()[2])) {
      continue;
    }
    out.tips.push_back({-1, body.ball->center_mm, covariance});
    out.rms_mm.push_back(body.ball->rms_mm);
  }
  fill_mask(grid, sheets, large, clay, bodies, scale, out.mask);
  return out;
}

std::vector<std::uint8_t> pin_mask(const RangeGrid& grid, double tip_diameter_mm,
                                   const PinDetectionOptions& options) {
  return detect_pins(grid, tip_diameter_mm, options).mask;
}

}  // namespace dubsar
