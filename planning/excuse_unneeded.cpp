// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/number_text.h"
#include "core/units.h"
#include "planning/clearing.h"
#include "planning/clusters.h"
#include "planning/excuse.h"

namespace dubsar {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kSides = 6;
constexpr int kElementsPerSide = 2;
/// A scan's noise is told at normal incidence; around a hole the surface is often steep.
constexpr double kNoiseOfSlopes = 1.3;

Vector6 quadric_terms(double u, double v) {
  Vector6 t;
  t << 1.0, u, v, u * u, u * v, v * v;
  return t;
}

/// How well a quadric through the surroundings stands in for a hole; mm.
struct Interpolation {
  double width_mm = 0;                  ///< of the hole
  double bend_mm = 0;                   ///< by which the surroundings deviate from the quadric beyond noise
  double error_mm = 0;                  ///< of the fit at the worst place in the hole, one standard error
  double deviation_mm = 0;              ///< of the worst red sample from it
  std::vector<Eigen::Vector3d> filled;  ///< the interpolated place of each target
};

std::optional<Interpolation> interpolate(const SurfaceCover& cover, const RedTargets& red,
                                         std::span<const std::uint32_t> group, double noise_mm,
                                         double margin_mm) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const std::uint32_t t : group) {
    center += red.targets[t].position_mm / static_cast<double>(group.size());
  }
  Interpolation out;
  for (const std::uint32_t t : group) {
    out.width_mm = std::max({out.width_mm, 2 * (red.targets[t].position_mm - center).norm(),
                             2 * (red.targets[t].sample_mm - center).norm()});
  }
  const std::vector<SurfaceCover::Element> around = cover.within(center, 0.5 * out.width_mm + margin_mm);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const auto& e : around) {
    normal += e.normal.cast<double>();
  }
  if (around.size() < 18 || !(normal.norm() > 0)) {
    return std::nullopt;
  }
  normal.normalize();
  const Eigen::Vector3d u_axis = normal.unitOrthogonal();
  const Eigen::Vector3d v_axis = normal.cross(u_axis);
  std::array<int, kSides> sides{};
  Matrix6 moments = Matrix6::Zero();
  Vector6 heights = Vector6::Zero();
  for (const auto& e : around) {
    const Eigen::Vector3d p = e.position_mm.cast<double>() - center;
    const double u = u_axis.dot(p);
    const double v = v_axis.dot(p);
    const double turn = (std::atan2(v, u) + kPi) / (2 * kPi);
    ++sides[static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSides), 0, kSides - 1))];
    const Vector6 t = quadric_terms(u, v);
    moments += t * t.transpose();
    heights += t * normal.dot(p);
  }
  if (*std::min_element(sides.begin(), sides.end()) < kElementsPerSide) {
    return std::nullopt;
  }
  const Eigen::LDLT<Matrix6> solver(moments);
  const Vector6 quadric = solver.solve(heights);
  if (solver.info() != Eigen::Success || !quadric.allFinite()) {
    return std::nullopt;
  }
  double squares = 0;
  for (const auto& e : around) {
    const Eigen::Vector3d p = e.position_mm.cast<double>() - center;
    const double d = normal.dot(p) - quadric.dot(quadric_terms(u_axis.dot(p), v_axis.dot(p)));
    squares += d * d;
  }
  const double variance = squares / static_cast<double>(around.size() - 6);
  const double expected = kNoiseOfSlopes * kNoiseOfSlopes * noise_mm * noise_mm;
  out.bend_mm = std::sqrt(std::max(0.0, variance - expected));
  for (const std::uint32_t i : group) {
    const Eigen::Vector3d p = red.targets[i].position_mm - center;
    const Vector6 t = quadric_terms(u_axis.dot(p), v_axis.dot(p));
    out.error_mm = std::max(out.error_mm, std::sqrt(variance * std::max(0.0, t.dot(solver.solve(t)))));
    out.filled.push_back(center + u_axis * u_axis.dot(p) + v_axis * v_axis.dot(p) + normal * quadric.dot(t));
    const Eigen::Vector3d s = red.targets[i].sample_mm - center;
    out.deviation_mm = std::max(
        out.deviation_mm, std::abs(normal.dot(s) - quadric.dot(quadric_terms(u_axis.dot(s), v_axis.dot(s)))));
  }
  return out;
}

std::string describe(const Interpolation& fit, double good_to_mm) {
  return "gap of " + fixed_text(fit.width_mm, 2) + " mm; its surroundings bend by " +
         fixed_text(1000 * fit.bend_mm, 0) + " µm from a quadric, interpolation good to " +
         fixed_text(1000 * good_to_mm, 0) + " µm";
}

}  // namespace

void excuse_unneeded(std::span<const PlacedScan> scans, const SurfaceCover& cover, double noise_mm,
                     const ExcuseOptions& options, RedTargets& red) {
  for (const auto& group :
       cluster_targets(red, scans, 2.0 * red.cell_mm, 2.0 * options.largest_gap_mm, true)) {
    if (red.targets[group.front()].state != RegionState::kRed) {
      continue;
    }
    Eigen::AlignedBox3d box;
    for (const std::uint32_t t : group) {
      box.extend(red.targets[t].position_mm);
    }
    if (box.diagonal().norm() > options.largest_gap_mm) {
      continue;
    }
    const double margin_mm = std::max(options.fit_margin_mm, 4.5 * cover.spacing_mm_at(box.center()));
    const auto fit = interpolate(cover, red, group, noise_mm, margin_mm);
    if (!fit || fit->width_mm > options.largest_gap_mm) {
      continue;
    }
    const double good_to_mm = fit->bend_mm + options.confidence_sigmas * fit->error_mm;
    if (good_to_mm > options.interpolation_mm ||
        fit->deviation_mm > good_to_mm + 3 * kNoiseOfSlopes * noise_mm) {
      continue;
    }
    const std::string reason = describe(*fit, good_to_mm);
    for (std::size_t k = 0; k < group.size(); ++k) {
      red.targets[group[k]].excuse_as(Excuse::kUnneeded, reason);
      red.targets[group[k]].interpolated_mm = fit->filled[k];
    }
  }
}

}  // namespace dubsar
