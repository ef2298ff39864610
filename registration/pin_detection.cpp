// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_detection.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "core/grid_noise.h"
#include "core/parallel.h"
#include "core/units.h"
#include "registration/pin_body.h"
#include "registration/pin_components.h"
#include "registration/pin_noise.h"

namespace dubsar {

namespace {

/// Residuals of a sample on a pin, in standard deviations of the noise along the ray.
constexpr double kSampleSigmas = 4.0;
/// Outliers that may lie beyond a tip, of the samples of the ball's disc.
constexpr double kMostStrays = 0.05;
/// Samples on the ball's cap, of those of its disc: the free half seen side on has three times as many there.
constexpr double kLeastCapShare = 0.06;
/// How much worse a cut-off arm must explain the cap than a ball.
constexpr double kLeastCylinderRatio = 4.0;
/// Where a ball explains the cap so much better, nothing else is asked.
constexpr double kClearCylinderRatio = 15.0;
/// Offset of a ball from its arm's axis: what pins are bent, of the radius, and what the fit's error makes.
constexpr double kMostOffAxis = 0.08;
constexpr double kOffAxisSigmas = 4.0;
/// Samples of a piece whose surroundings are looked at.
constexpr std::size_t kClearSamples = 96;
/// The smallest piece that is looked at, of the samples of a ball's disc.
constexpr double kLeastDiscs = 0.2;

/// What one scan's pins are measured by.
struct Scale {
  double radius_mm = 0;                  ///< of a tip
  double spacing_mm = 0;                 ///< µ
  double noise_mm = 0;                   ///< along the ray
  double disc = 0;                       ///< samples of a ball's whole disc
  double on_arm_mm = 0, on_ball_mm = 0;  ///< residuals of inliers
};

/// A component that is an arm, with its tip where it shows it.
struct Body {
  Cone cone;  ///< its axis runs from the tip outwards
  std::optional<Ball> ball;
  std::vector<std::uint32_t> samples;
  RowNoiseSums noise;
  bool settled = true;  ///< else only its place among the others can tell that it is no clay
};

struct Piece {
  std::vector<std::uint32_t> samples;
  std::vector<Eigen::Vector3d> points_mm;
  Eigen::Vector3d to_camera{0, 0, 1};
};

Piece piece_of(const RangeGrid& grid, const Sheets& sheets, std::size_t component) {
  Piece piece;
  piece.samples = samples_of(sheets, grid, component);
  piece.points_mm.reserve(piece.samples.size());
  for (const std::uint32_t i : piece.samples) {
    piece.points_mm.push_back(grid.point(i).cast<double>());
  }
  const std::uint32_t middle = piece.samples[piece.samples.size() / 2];
  piece.to_camera = grid.view.to_camera(grid.point(middle).cast<double>(), grid.row_of(middle));
  return piece;
}

/// Samples of the piece at the border of the field.
int at_border(const RangeGrid& grid, const std::vector<std::uint32_t>& samples) {
  return static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](std::uint32_t i) {
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    return row == 0 || col == 0 || row + 1 == grid.rows || col + 1 == grid.cols;
  }));
}

/// True when the field ends where the cone's low end is.
bool cut_by_field(const RangeGrid& grid, const Piece& piece, const Cone& cone, double radius_mm) {
  std::vector<std::uint32_t> low_end;
  for (std::size_t k = 0; k < piece.samples.size(); ++k) {
    if (cone.along(piece.points_mm[k]) < cone.low_mm + 2 * radius_mm) {
      low_end.push_back(piece.samples[k]);
    }
  }
  return at_border(grid, low_end) >= 2;
}

/// The ball at the cone's low end, if there is one.
std::optional<Ball> tip_of(const RangeGrid& grid, const Piece& piece, const Cone& cone, const Scale& scale,
                           const PinDetectionOptions& options) {
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
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(first), places.end());
  const Eigen::Vector3d start = cone.point_mm + (places[first] + r) * cone.axis;
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

/// Share of the piece's samples that no other component with large[c] != 0 comes near: clay that wedges and
/// their shadows cut off from the rest still lies among it, while an arm runs away from it.
double standing_clear(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& large,
                      const Piece& piece, double clear_mm, double spacing_mm) {
  const int reach = static_cast<int>(std::ceil(clear_mm / spacing_mm));
  const int hop = std::max(1, reach / 8);
  const auto clear2 = static_cast<float>(clear_mm * clear_mm);
  const std::size_t stride = std::max<std::size_t>(1, piece.samples.size() / kClearSamples);
  const std::int32_t own = sheets.label[piece.samples.front()];
  std::size_t looked = 0;
  std::size_t clear = 0;
  for (std::size_t k = stride / 2; k < piece.samples.size(); k += stride) {
    const std::uint32_t i = piece.samples[k];
    bool near = false;
    for (int dr = -reach; dr <= reach && !near; dr += hop) {
      for (int dc = -reach; dc <= reach && !near; dc += hop) {
        const int row = grid.row_of(i) + dr;
        const int col = grid.col_of(i) + dc;
        if (!grid.inside(row, col)) {
          continue;
        }
        const std::size_t j = grid.index(row, col);
        near = sheets.label[j] >= 0 && sheets.label[j] != own &&
               large[static_cast<std::size_t>(sheets.label[j])] != 0 &&
               (grid.point(j) - grid.point(i)).squaredNorm() < clear2;
      }
    }
    ++looked;
    clear += near ? 0U : 1U;
  }
  return looked > 0 ? static_cast<double>(clear) / static_cast<double>(looked) : 0.0;
}

/// An arm seen in full shows almost half of its girth. Less is believed of a long piece only: something in
/// front may hide it along its length, but small pieces of clay bend like that too.
bool shows_enough(const Cone& cone, std::size_t samples, const Scale& scale,
                  const PinDetectionOptions& options) {
  const double width = cone.radius_at(cone.low_mm) + cone.radius_at(cone.high_mm);
  const bool in_full = cone.coverage_rad >= options.full_coverage_rad &&
                       cone.high_mm - cone.low_mm >= options.least_length * width;
  const bool in_part = cone.coverage_rad >= options.least_coverage_rad &&
                       cone.high_mm - cone.low_mm >= 2 * options.least_length * width &&
                       static_cast<double>(samples) >= options.least_part_discs * scale.disc;
  return in_full || in_part;
}

bool plausible_arm(const Cone& cone, const Scale& scale, const PinDetectionOptions& options) {
  const double a = cone.radius_at(cone.low_mm);
  const double b = cone.radius_at(cone.high_mm);
  return std::min(a, b) >= options.least_arm_radius * scale.radius_mm &&
         std::max(a, b) <= options.most_width * scale.radius_mm &&
         cone.inlier_share >= options.least_arm_share &&
         cone.rms_mm <= std::max(options.most_arm_noise * scale.noise_mm, 0.04 * scale.radius_mm);
}

std::optional<Body> body_of(const RangeGrid& grid, const Sheets& sheets,
                            const std::vector<std::uint8_t>& large, bool alone, Piece piece,
                            const Scale& scale, const PinDetectionOptions& options) {
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
  Body body;
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

/// Covariance of the ball's centre: H⁻¹ M H⁻¹ with H = Σ w n nᵀ and M = Σ w_i w_j cov(i, j) n_i n_jᵀ over the
/// samples of a row.
Eigen::Matrix3d covariance_of(const RangeGrid& grid, const Body& body, const RowNoise& noise) {
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

/// True where the sample lies on the arm, or on what would be more of it farther out.
bool in_envelope(const Body& body, const Eigen::Vector3d& p, double margin_mm, double radius_mm, bool alone) {
  const double s = body.cone.along(p);
  // Without its tip, which way an arm goes on is not known: the tablet may be there.
  const bool before_tip = body.ball && s < body.cone.along(body.ball->center_mm) - radius_mm - margin_mm;
  const bool off_end =
      !body.ball && !alone && (s < body.cone.low_mm - margin_mm || s > body.cone.high_mm + margin_mm);
  if (before_tip || off_end) {
    return false;
  }
  return body.cone.from_axis(p) <= std::max(radius_mm, body.cone.radius_at(s)) + margin_mm;
}

/// Drops the bodies that are not settled and have pieces of other shapes near: clay that shadows cut up.
void drop_unsettled(const RangeGrid& grid, const Sheets& sheets, double near_mm, double spacing_mm,
                    std::vector<std::optional<Body>>& found) {
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

/// Marks what is left of an arm that is hidden but for a corner: pieces that nothing connects with clay and
/// that reach the border of the field, or have nothing but arms around them. Clay that shadows cut into
/// pieces has more of its pieces near.
void mask_remnants(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& clay,
                   const std::vector<std::optional<Body>>& found, double far_mm, double spacing_mm,
                   std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> other(sheets.components.size(), 1);
  for (std::size_t c = 0; c < other.size(); ++c) {
    other[c] = found[c] ? 0 : 1;
  }
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (clay[c] != 0 || found[c]) {
          return;
        }
        const Piece piece = piece_of(grid, sheets, c);
        if (at_border(grid, piece.samples) >= 2 ||
            standing_clear(grid, sheets, other, piece, far_mm, spacing_mm) >= 1.0) {
          for (const std::uint32_t i : piece.samples) {
            mask[i] = 1;
          }
        }
      },
      4);
}

/// Marks the bodies, what lies in their envelopes and is no part of a large thing, and single samples beside
/// them that hang on to nothing else.
void fill_mask(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& large,
               const std::vector<std::uint8_t>& clay, const std::vector<Body>& bodies, const Scale& scale,
               std::vector<std::uint8_t>& mask) {
  const double margin_mm = std::max(1.5 * scale.spacing_mm, 6.0 * scale.noise_mm);
  const auto in_any = [&](std::size_t i, bool alone) {
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    return std::any_of(bodies.begin(), bodies.end(),
                       [&](const Body& b) { return in_envelope(b, p, margin_mm, scale.radius_mm, alone); });
  };
  for (const Body& body : bodies) {
    for (const std::uint32_t i : body.samples) {
      mask[i] = 1;
    }
  }
  // Pieces of arms that were too small or too hidden to be known by themselves.
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (large[c] != 0) {
          return;
        }
        const std::vector<std::uint32_t> samples = samples_of(sheets, grid, c);
        if (samples.empty() || mask[samples.front()] != 0) {
          return;
        }
        const auto inside = static_cast<std::size_t>(std::count_if(
            samples.begin(), samples.end(), [&](std::uint32_t i) { return in_any(i, clay[c] == 0); }));
        if (10 * inside >= 7 * samples.size()) {
          for (const std::uint32_t i : samples) {
            mask[i] = 1;
          }
        }
      },
      4);
  const std::vector<std::uint8_t> known = mask;
  const auto step2 = static_cast<float>(std::pow(4.0 * scale.spacing_mm, 2));
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t row) {
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = grid.index(static_cast<int>(row), col);
          if (grid.valid[i] == 0 || sheets.label[i] >= 0 || !grid.point(i).allFinite()) {
            continue;
          }
          if (in_any(i, false)) {
            mask[i] = 1;
            continue;
          }
          float to_pin2 = step2;
          float to_other2 = step2;
          for (int dr = -1; dr <= 1; ++dr) {
            for (int dc = -1; dc <= 1; ++dc) {
              const int r = static_cast<int>(row) + dr;
              const int c = col + dc;
              if (!grid.is_valid(r, c) || sheets.label[grid.index(r, c)] < 0) {
                continue;
              }
              const std::size_t j = grid.index(r, c);
              float& nearest = known[j] != 0 ? to_pin2 : to_other2;
              nearest = std::min(nearest, (grid.point(j) - grid.point(i)).squaredNorm());
            }
          }
          mask[i] = to_pin2 < to_other2 ? 1 : 0;
        }
      },
      16);
}

}  // namespace

PinDetection detect_pins(const RangeGrid& grid, double tip_diameter_mm, const PinDetectionOptions& options) {
  PinDetection out;
  out.mask.assign(grid.size(), 0);
  Scale scale;
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
  std::vector<std::optional<Body>> found(sheets.components.size());
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (large[c] == 0 && static_cast<double>(sheets.components[c].cells) >= kLeastDiscs * scale.disc) {
          found[c] = body_of(grid, sheets, large, clay[c] == 0, piece_of(grid, sheets, c), scale, options);
        }
      },
      1);
  drop_unsettled(grid, sheets, options.near_mm, scale.spacing_mm, found);
  mask_remnants(grid, sheets, clay, found, options.far_mm, scale.spacing_mm, out.mask);
  std::vector<Body> bodies;
  RowNoiseSums sums;
  for (std::optional<Body>& body : found) {
    if (body) {
      sums.add(body->noise);
      bodies.push_back(std::move(*body));
    }
  }
  const RowNoise noise = sums.noise();
  out.noise_mm = std::sqrt(noise.at(0));
  for (Body& body : bodies) {
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
