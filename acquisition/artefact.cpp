// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// VDI/VDE 2634 part 2, Optical 3D measuring systems: systems with area scanning.
#include "acquisition/artefact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "acquisition/ball_face.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/plane_outline.h"
#include "acquisition/sphere_fit.h"
#include "core/number_text.h"
#include "core/random.h"

namespace dubsar {

namespace {

constexpr std::size_t kLeastParts = 18;  // three quarters of a ball's face
constexpr double kSeenOfPlane = 0.9;     // of its sides: the last samples at an edge are seldom good
constexpr int kTries = 6000;
constexpr std::size_t kLeastOnBall = 100;
constexpr double kBesidePlaneMm = 1.0;  // what lies less far off makes the outline

struct Found {
  Sphere sphere;
  std::vector<Eigen::Vector3d> points_mm;
  LeftOut left_out;
};

std::string micrometres(double mm) {
  return number_text(std::round(1e4 * mm) / 10) + " µm";
}

/// Largest less smallest value when the share of samples that lie farthest from the middle has been left out,
/// those among it that were left out before.
double range_of(std::vector<double> values, std::size_t left_out) {
  const auto may_be = static_cast<std::size_t>(kMayBeLeftOut * static_cast<double>(values.size() + left_out));
  const std::size_t drop = may_be - std::min(may_be, left_out);
  std::sort(values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  values.resize(values.size() - drop);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

std::string rounded_mm(double mm) {
  return number_text(std::round(10 * mm) / 10);
}

/// The part of a ball that counts: near the sphere, facing the scanner.
std::vector<Eigen::Vector3d> on_ball(const std::vector<Eigen::Vector3d>& points, const Sphere& sphere,
                                     const Eigen::Vector3d& towards, double tolerance_mm) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector3d& p : points) {
    if (std::abs(sphere.signed_distance_mm(p)) <= tolerance_mm && before_face(p, sphere, towards)) {
      out.push_back(p);
    }
  }
  return out;
}

/// What is seen before a ball's face and is not on it. Farther out than half a radius it is another thing.
LeftOut off_ball(const std::vector<Eigen::Vector3d>& points, const Sphere& sphere,
                 const Eigen::Vector3d& towards, double tolerance_mm) {
  LeftOut out;
  for (const Eigen::Vector3d& p : points) {
    const double d = sphere.signed_distance_mm(p);
    if (std::abs(d) > tolerance_mm && d < 0.5 * sphere.radius_mm && before_face(p, sphere, towards)) {
      out.add(std::abs(d));
    }
  }
  return out;
}

/// The point stands over the plate where a ball or what joins two of them stands: no part of the plane is
/// seen there.
bool under_balls(const Eigen::Vector3d& point, const std::vector<Found>& balls,
                 const Eigen::Vector3d& towards) {
  constexpr double kFoot = 1.25;  // radii
  const auto flat = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d { return v - v.dot(towards) * towards; };
  for (const Found& a : balls) {
    for (const Found& b : balls) {
      const Eigen::Vector3d way = flat(b.sphere.center_mm - a.sphere.center_mm);
      const Eigen::Vector3d arm = flat(point - a.sphere.center_mm);
      const double t = std::clamp(arm.dot(way) / std::max(1e-12, way.squaredNorm()), 0.0, 1.0);
      if ((arm - t * way).norm() < kFoot * std::max(a.sphere.radius_mm, b.sphere.radius_mm)) {
        return true;
      }
    }
  }
  return false;
}

std::unexpected<Error> cancelled(const RangeGrid& grid) {
  return fail(ErrorKind::kCancelled, "verification cancelled", grid.source);
}

/// The ball of this diameter with the most samples on it. `free` says of each cell of the grid whether its
/// sample is still to be had. Nothing also where the job was cancelled.
std::optional<Found> find_ball(const RangeGrid& grid, const std::vector<std::uint8_t>& free,
                               double diameter_mm, double form_limit_mm, const Eigen::Vector3d& towards,
                               Random& random, const JobContext& job) {
  std::vector<std::size_t> cells;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i] != 0) {
      cells.push_back(i);
      points.push_back(grid.point(i).cast<double>());
    }
  }
  if (points.size() < kLeastOnBall) {
    return std::nullopt;
  }
  const double radius = 0.5 * diameter_mm;
  const double tolerance = 0.03 * radius;
  // What the limit allows is on the ball.
  const double in_the_end = std::clamp(form_limit_mm, tolerance, 0.1 * radius);
  const double spacing = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  const auto reach = static_cast<std::uint64_t>(std::max(2.0, 0.7 * radius / std::max(1e-6, spacing)));
  Sphere best;
  std::size_t most = 0;
  // Counting on a part of the samples is enough to choose between candidates.
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 4000);
  for (int i = 0; i < kTries; ++i) {
    if (job.cancelled()) {
      return std::nullopt;
    }
    const std::size_t seed = random.below(cells.size());
    const Eigen::Vector3d& a = points[seed];
    std::array<Eigen::Vector3d, 3> others;
    bool near = true;
    for (Eigen::Vector3d& other : others) {
      const int row =
          grid.row_of(cells[seed]) + static_cast<int>(random.below(2 * reach + 1)) - static_cast<int>(reach);
      const int col =
          grid.col_of(cells[seed]) + static_cast<int>(random.below(2 * reach + 1)) - static_cast<int>(reach);
      near = near && grid.inside(row, col) && free[grid.index(row, col)] != 0;
      if (near) {
        other = grid.point(grid.index(row, col)).cast<double>();
        near = (other - a).norm() < 1.8 * radius && (other - a).norm() > 0.1 * radius;
      }
    }
    if (!near) {
      continue;
    }
    const auto sphere = sphere_through(a, others[0], others[1], others[2]);
    if (!sphere || std::abs(sphere->radius_mm - radius) > 0.1 * radius ||
        (a - sphere->center_mm).dot(towards) < 0) {
      continue;
    }
    std::size_t count = 0;
    for (std::size_t k = 0; k < points.size(); k += stride) {
      count += std::abs(sphere->signed_distance_mm(points[k])) <= tolerance ? 1 : 0;
    }
    if (count > most) {
      most = count;
      best = *sphere;
    }
  }
  if (most * stride < kLeastOnBall) {
    return std::nullopt;
  }
  Found out{best, {}, {}};
  for (int round = 0; round < 4; ++round) {
    out.points_mm = on_ball(points, out.sphere, towards, round < 2 ? 2 * tolerance : in_the_end);
    const auto fitted = fit_sphere(out.points_mm, out.sphere);
    if (!fitted) {
      return std::nullopt;
    }
    out.sphere = *fitted;
  }
  if (std::abs(out.sphere.radius_mm - radius) > 0.1 * radius || out.points_mm.size() < kLeastOnBall) {
    return std::nullopt;
  }
  out.left_out = off_ball(points, out.sphere, towards, in_the_end);
  return out;
}

/// Which found ball is which: the order whose distances agree best with the certificate.
std::vector<std::size_t> assigned(const std::vector<Found>& found, const Artefact& artefact) {
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> best = order;
  double least = 1e300;
  do {
    double sum = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Artefact::Ball& ball = artefact.balls[i];
      sum += std::pow(2 * found[order[i]].sphere.radius_mm - ball.diameter_mm, 2);
      for (std::size_t k = 0; k < i; ++k) {
        const double is = (found[order[i]].sphere.center_mm - found[order[k]].sphere.center_mm).norm();
        sum += std::pow(is - (ball.center_mm - artefact.balls[k].center_mm).norm(), 2);
      }
    }
    if (sum < least) {
      least = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

/// Ends early where the job is cancelled.
void measure_plane(const std::vector<Eigen::Vector3d>& points, const std::vector<Found>& balls,
                   const Artefact& artefact, const Eigen::Vector3d& towards, const JobContext& job,
                   Verification& out) {
  const Result<PlaneFit> fit = fit_plane(points);
  if (!fit) {
    out.failed.emplace_back("the plane was not found");
    return;
  }
  // What lies far off is another thing; what lies a little off is the error that is asked for.
  const double little = std::max({0.1, 10 * fit->rms_mm, artefact.flatness_limit_mm});
  std::vector<double> distances;
  std::vector<Eigen::Vector3d> on_plane;
  std::vector<Eigen::Vector3d> beside;
  for (const Eigen::Vector3d& p : points) {
    const double d = fit->plane.signed_distance_mm(p);
    if (std::abs(d) < little) {
      distances.push_back(d);
      on_plane.push_back(p);
    }
    if (std::abs(d) < std::max(little, kBesidePlaneMm)) {
      beside.push_back(p);
    }
  }
  if (distances.size() < kLeastOnBall) {
    out.failed.emplace_back("the plane was not found");
    return;
  }
  // Within the plane's outline it is the plane, however far off, but for what stands on it.
  const double up = fit->plane.normal.dot(towards) > 0 ? 1 : -1;
  const PlaneOutline outline(fit->plane, beside);
  for (const Eigen::Vector3d& p : points) {
    if (job.cancelled()) {
      return;
    }
    const double d = fit->plane.signed_distance_mm(p);
    if (std::abs(d) >= little && outline.inside(p) && !(up * d > 0 && under_balls(p, balls, towards))) {
      out.plane_left_out.add(std::abs(d));
    }
  }
  out.plane_samples = distances.size();
  out.plane_mm = PlaneOutline(fit->plane, on_plane).sides_mm();
  out.flatness_mm = range_of(distances, out.plane_left_out.count);
}

void judge(const Artefact& artefact, Verification& out) {
  const auto over = [&](const std::string& what, double is, double limit) {
    if (std::abs(is) > limit) {
      out.failed.push_back(what + ": " + micrometres(is) + ", the limit " + micrometres(limit));
    }
  };
  const auto off = [&](const std::string& what, const LeftOut& left, std::size_t samples,
                       const std::string& where) {
    if (left.too_many(samples)) {
      out.failed.push_back(what + ": " + std::to_string(left.count) + where +
                           std::to_string(left.count + samples) + ", by up to " +
                           micrometres(left.farthest_mm) + "; three in a thousand may be");
    }
  };
  for (const MeasuredBall& ball : out.balls) {
    const std::string number = std::to_string(ball.certified + 1);
    if (ball.parts_seen < kLeastParts) {
      out.failed.push_back("seen of ball " + number + ": " + std::to_string(ball.parts_seen) +
                           " parts of its face, of " + std::to_string(kFaceParts) + ", and at least " +
                           std::to_string(kLeastParts) + " have to be");
    }
    off("off ball " + number, ball.left_out, ball.samples, " samples before its face, of ");
    over("probing error (form) of ball " + number, ball.form_mm, artefact.form_limit_mm);
    over("probing error (size) of ball " + number, ball.size_mm, artefact.size_limit_mm);
  }
  for (const MeasuredSpacing& spacing : out.spacings) {
    over("sphere spacing error of balls " + std::to_string(spacing.a + 1) + ", " +
             std::to_string(spacing.b + 1),
         spacing.error_mm, artefact.spacing_limit_mm);
  }
  if (out.flatness_mm && (out.plane_mm[0] < kSeenOfPlane * artefact.plane_mm[0] ||
                          out.plane_mm[1] < kSeenOfPlane * artefact.plane_mm[1])) {
    out.failed.push_back("the plane was seen over " + rounded_mm(out.plane_mm[0]) + " x " +
                         rounded_mm(out.plane_mm[1]) + " mm only, and it has " +
                         rounded_mm(artefact.plane_mm[0]) + " x " + rounded_mm(artefact.plane_mm[1]) + " mm");
  }
  if (out.flatness_mm) {
    off("off the plane", out.plane_left_out, out.plane_samples, " samples within its outline, of ");
    over("flatness error", *out.flatness_mm, artefact.flatness_limit_mm);
  }
}

}  // namespace

double Verification::worst_mm() const {
  const auto off = [](const LeftOut& left, std::size_t samples) {
    return left.too_many(samples) ? left.farthest_mm : 0.0;
  };
  double worst = std::max(flatness_mm.value_or(0), off(plane_left_out, plane_samples));
  for (const MeasuredBall& ball : balls) {
    worst = std::max({worst, ball.form_mm, std::abs(ball.size_mm), off(ball.left_out, ball.samples)});
  }
  for (const MeasuredSpacing& spacing : spacings) {
    worst = std::max(worst, std::abs(spacing.error_mm));
  }
  return worst;
}

Result<Verification> verify_artefact(const RangeGrid& grid, const Artefact& artefact, const JobContext& job) {
  std::vector<std::uint8_t> free = grid.valid;
  if (grid.valid_count() == 0) {
    return bad_input(grid.source, "there is not a single sample in the scan", "scan the artefact again");
  }
  const Eigen::Vector3d towards = -grid.view.direction.normalized();
  Random random(1);
  Verification out;
  std::vector<Found> found;
  for (const Artefact::Ball& wanted : artefact.balls) {
    std::optional<Found> ball =
        find_ball(grid, free, wanted.diameter_mm, artefact.form_limit_mm, towards, random, job);
    if (job.cancelled()) {
      return cancelled(grid);
    }
    if (!ball) {
      break;
    }
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i] != 0 &&
          (grid.point(i).cast<double>() - ball->sphere.center_mm).norm() < 1.05 * ball->sphere.radius_mm) {
        free[i] = 0;
      }
    }
    found.push_back(std::move(*ball));
  }
  if (found.size() < artefact.balls.size()) {
    out.failed.push_back("not all balls were found: " + std::to_string(found.size()) +
                         ", and the artefact has " + std::to_string(artefact.balls.size()));
  } else {
    const std::vector<std::size_t> order = assigned(found, artefact);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Found& ball = found[order[i]];
      std::vector<double> distances;
      distances.reserve(ball.points_mm.size());
      for (const Eigen::Vector3d& p : ball.points_mm) {
        distances.push_back(ball.sphere.signed_distance_mm(p));
      }
      const double diameter = 2 * ball.sphere.radius_mm;
      out.balls.push_back({i, ball.sphere.center_mm, diameter, range_of(distances, ball.left_out.count),
                           diameter - artefact.balls[i].diameter_mm, ball.points_mm.size(), ball.left_out,
                           seen_parts(ball.points_mm, ball.sphere, towards)});
      for (std::size_t k = 0; k < i; ++k) {
        const double is = (ball.sphere.center_mm - found[order[k]].sphere.center_mm).norm();
        const double should = (artefact.balls[i].center_mm - artefact.balls[k].center_mm).norm();
        out.spacings.push_back({k, i, is - should});
      }
    }
  }
  if (artefact.has_plane) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i] != 0) {
        points.push_back(grid.point(i).cast<double>());
      }
    }
    measure_plane(points, found, artefact, towards, job, out);
  }
  if (job.cancelled()) {  // nothing is known of what was not looked at
    return cancelled(grid);
  }
  judge(artefact, out);
  return out;
}

}  // namespace dubsar
