// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_arm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

/// Outliers that may lie beyond a tip, of the samples of the ball's disc.
constexpr double kMostStrays = 0.05;
/// Samples on the ball's cap, of those of its disc: the free half seen side on has three times as many there.
constexpr double kLeastCapShare = 0.06;
/// How much worse a cut-off arm must explain the cap than a ball.
constexpr double kLeastCylinderRatio = 4.0;

/// True when the field ends where the cone's low end is.
bool cut_by_field(const RangeGrid& grid, const GridPiece& piece, const Cone& cone, double radius_mm) {
  std::vector<std::uint32_t> low_end;
  for (std::size_t k = 0; k < piece.samples.size(); ++k) {
    if (cone.along(piece.points_mm[k]) < cone.low_mm + 2 * radius_mm) {
      low_end.push_back(piece.samples[k]);
    }
  }
  return at_border(grid, low_end) >= 2;
}

/// The ball at the cone's low end, if there is one.
std::optional<Ball> tip_of(const RangeGrid& grid, const GridPiece& piece, const Cone& cone,
                           const PinScale& scale, const PinDetectionOptions& options) {
  const double r = scale.radius_mm;
  if (cut_by_field(grid, piece, cone, r)) {
    return std::nullopt;
  }
  std::vector<double> places;
  places.reserve(piece.points_mm.size());
  for (const Eigen::Vector3d& p : piece.points_mm) {
    places.push_back(cone.along(p));
  }
  const auto strays = static_cast<std::size_t>(std::max(1.0, kMostStrays * scale.disc));
  const std::size_t first = std::min(strays, places.size() - 1);
  const Eigen::Vector3d start = cone.point_mm + (value_at_rank(places, first) + r) * cone.axis;
  std::optional<Ball> ball =
      fit_ball(piece.points_mm, start, cone.axis, piece.to_camera, r, scale.on_ball_mm);
  if (!ball ||
      static_cast<double>(ball->samples.size()) < std::max(6.0, options.least_disc_share * scale.disc) ||
      ball->cap < std::max(3.0, kLeastCapShare * scale.disc) || ball->cylinder_ratio < kLeastCylinderRatio ||
      ball->rms_mm > std::max(options.most_ball_rms * r, 3.0 * scale.noise_mm)) {
    return std::nullopt;
  }
  const double at = cone.along(ball->center_mm);
  if (cone.from_axis(ball->center_mm) > 0.5 * r || cone.radius_at(at) > 1.6 * r ||
      cone.radius_at(at) < 0.5 * r) {
    return std::nullopt;
  }
  std::size_t on_free_side = 0;
  std::size_t beyond = 0;
  for (const Eigen::Vector3d& p : piece.points_mm) {
    const double s = (p - ball->center_mm).dot(cone.axis);
    on_free_side += s <= 0.05 * r ? 1U : 0U;
    beyond += s < -1.3 * r ? 1U : 0U;
  }
  if (beyond > strays ||
      static_cast<double>(ball->samples.size()) < 0.7 * static_cast<double>(on_free_side)) {
    return std::nullopt;
  }
  return ball;
}

/// An arm seen in full shows almost half of its girth. Less is believed of a long piece only: something in
/// front may hide it along its length, but small pieces of clay bend like that too.
bool shows_enough(const Cone& cone, std::size_t samples, const PinScale& scale,
                  const PinDetectionOptions& options) {
  const double width = cone.radius_at(cone.low_mm) + cone.radius_at(cone.high_mm);
  const bool in_full = cone.coverage_rad >= options.full_coverage_rad &&
                       cone.high_mm - cone.low_mm >= options.least_length * width;
  const bool in_part = cone.coverage_rad >= options.least_coverage_rad &&
                       cone.high_mm - cone.low_mm >= 2 * options.least_length * width &&
                       static_cast<double>(samples) >= options.least_part_discs * scale.disc;
  return in_full || in_part;
}

bool plausible_arm(const Cone& cone, const PinScale& scale, const PinDetectionOptions& options) {
  const double a = cone.radius_at(cone.low_mm);
  const double b = cone.radius_at(cone.high_mm);
  return std::min(a, b) >= options.least_arm_radius * scale.radius_mm &&
         std::max(a, b) <= options.most_width * scale.radius_mm &&
         cone.inlier_share >= options.least_arm_share &&
         cone.rms_mm <= std::max(options.most_arm_noise * scale.noise_mm, 0.04 * scale.radius_mm);
}

}  // namespace

std::optional<PinArm> find_pin_arm(const RangeGrid& grid, const Sheets& sheets,
                                   const std::vector<std::uint8_t>& large, bool alone, GridPiece piece,
                                   const PinScale& scale, const PinDetectionOptions& options) {
  const std::optional<Cone> cone = fit_cone(piece.points_mm, piece.to_camera, scale.on_arm_mm);
  if (!cone || !plausible_arm(*cone, scale, options)) {
    return std::nullopt;
  }
  const double clear_mm = std::min(1.6 * scale.radius_mm, options.most_clear_mm);
  const bool settled = shows_enough(*cone, piece.samples.size(), scale, options) &&
                       (alone || standing_clear(grid, sheets, large, piece, clear_mm, scale.spacing_mm) >=
                                     options.least_clear_share);
  if (!settled && !alone) {
    return std::nullopt;
  }
  PinArm body;
  body.settled = settled;
  body.cone = cone->slope >= 0 ? *cone : cone->reversed();  // an arm widens from its tip
  body.ball = tip_of(grid, piece, body.cone, scale, options);
  if (!body.ball) {
    const Cone other = body.cone.reversed();
    body.ball = tip_of(grid, piece, other, scale, options);
    body.cone = body.ball ? other : body.cone;
  }
  std::vector<Residual> residuals;
  const double begin_mm = body.ball ? body.cone.along(body.ball->center_mm) : body.cone.low_mm;
  for (std::size_t k = 0; k < piece.samples.size(); ++k) {
    const double s = body.cone.along(piece.points_mm[k]);
    const double r = body.cone.from_axis(piece.points_mm[k]) - body.cone.radius_at(s);
    if (s > begin_mm && std::abs(r) <= scale.on_arm_mm) {
      residuals.push_back({static_cast<std::uint32_t>(grid.row_of(piece.samples[k])),
                           static_cast<std::uint32_t>(grid.col_of(piece.samples[k])), r});
    }
  }
  body.noise.add(residuals);
  body.samples = std::move(piece.samples);
  return body;
}

}  // namespace dubsar
