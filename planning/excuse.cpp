// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/excuse.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "core/parallel.h"
#include "core/units.h"
#include "planning/clearing.h"
#include "planning/clusters.h"
#include "planning/convex_hull.h"
#include "planning/view_prediction.h"

namespace dubsar {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kSides = 6;
constexpr int kSamplesPerSide = 2;

Vector6 quadric_terms(double u, double v) {
  Vector6 t;
  t << 1.0, u, v, u * u, u * v, v * v;
  return t;
}

/// How well a quadric through the surroundings stands in for a hole of one scan; mm.
struct Interpolation {
  double residual_mm = 0;  ///< standard deviation of the fit
  double error_mm = 0;     ///< of the fit at the worst red sample, at the stated confidence
  double width_mm = 0;     ///< of the hole
};

std::optional<Interpolation> interpolate(const PlacedScan& scan, std::span<const std::uint32_t> reds,
                                         const ExcuseOptions& options) {
  const RangeGrid& grid = *scan.grid;
  int row_lo = grid.rows;
  int row_hi = 0;
  int col_lo = grid.cols;
  int col_hi = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : reds) {
    row_lo = std::min(row_lo, grid.row_of(i));
    row_hi = std::max(row_hi, grid.row_of(i));
    col_lo = std::min(col_lo, grid.col_of(i));
    col_hi = std::max(col_hi, grid.col_of(i));
    center += grid.point(i).cast<double>() / static_cast<double>(reds.size());
  }
  std::vector<Eigen::Vector3d> good;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const auto step_mm = static_cast<float>(5.0 * spacing_of(grid));
  for (int r = row_lo - options.fit_margin; r <= row_hi + options.fit_margin; ++r) {
    for (int c = col_lo - options.fit_margin; c <= col_hi + options.fit_margin; ++c) {
      if (grid.is_valid(r, c) && is_unflagged((*scan.flags)[grid.index(r, c)])) {
        good.push_back(grid.point(grid.index(r, c)).cast<double>() - center);
        normal += sample_normal(grid, grid.index(r, c), step_mm).cast<double>();
      }
    }
  }
  if (good.size() < 18 || !(normal.norm() > 0)) {
    return std::nullopt;
  }
  normal.normalize();
  const Eigen::Vector3d u_axis = normal.unitOrthogonal();
  const Eigen::Vector3d v_axis = normal.cross(u_axis);
  std::array<int, kSides> sides{};
  Matrix6 moments = Matrix6::Zero();
  Vector6 heights = Vector6::Zero();
  for (const Eigen::Vector3d& p : good) {
    const double u = u_axis.dot(p);
    const double v = v_axis.dot(p);
    const double turn = (std::atan2(v, u) + kPi) / (2 * kPi);
    ++sides[static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSides), 0, kSides - 1))];
    const Vector6 t = quadric_terms(u, v);
    moments += t * t.transpose();
    heights += t * normal.dot(p);
  }
  if (*std::min_element(sides.begin(), sides.end()) < kSamplesPerSide) {
    return std::nullopt;
  }
  const Eigen::LDLT<Matrix6> solver(moments);
  const Vector6 quadric = solver.solve(heights);
  if (solver.info() != Eigen::Success || !quadric.allFinite()) {
    return std::nullopt;
  }
  double squares = 0;
  for (const Eigen::Vector3d& p : good) {
    const double e = normal.dot(p) - quadric.dot(quadric_terms(u_axis.dot(p), v_axis.dot(p)));
    squares += e * e;
  }
  Interpolation out;
  out.residual_mm = std::sqrt(squares / static_cast<double>(good.size() - 6));
  for (const std::uint32_t i : reds) {
    const Eigen::Vector3d p = grid.point(i).cast<double>() - center;
    const Vector6 t = quadric_terms(u_axis.dot(p), v_axis.dot(p));
    const double leverage = std::max(0.0, t.dot(solver.solve(t)));
    out.error_mm = std::max(out.error_mm, options.confidence_sigmas * out.residual_mm * std::sqrt(leverage));
    out.width_mm = std::max(out.width_mm, 2 * p.norm());
    if (std::abs(normal.dot(p) - quadric.dot(t)) > options.interpolation_mm + 3 * out.residual_mm) {
      return std::nullopt;
    }
  }
  return out;
}

std::string describe(const Interpolation& fit, double spacing_mm) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(),
                "gap of %.2f mm; a quadric fits its surroundings to %.0f µm, interpolation good to %.0f µm",
                std::max(fit.width_mm, spacing_mm), 1000 * fit.residual_mm, 1000 * fit.error_mm);
  return line.data();
}

/// True when rays in nearly all directions meet the surface from within.
bool inside_clay(const MeshQuery& query, const Eigen::Vector3d& p_mm) {
  constexpr std::size_t kRays = 40;
  constexpr std::size_t kNearlyAll = 36;  // some slip through slits and holes
  std::size_t within = 0;
  for (const Eigen::Vector3d& direction : sphere_directions(kRays)) {
    const Eigen::Vector3f ray = direction.cast<float>();
    const auto hit = query.first_hit(p_mm.cast<float>(), ray, 0.0F, 1.0e4F);
    within += hit && hit->normal.dot(ray) > 0 ? 1U : 0U;
  }
  return within >= kNearlyAll;
}

void set_excuse(RedTarget& target, Excuse excuse, std::string reason) {
  target.state = RegionState::kExcused;
  target.excuse = excuse;
  target.reason = std::move(reason);
}

}  // namespace

void excuse_unneeded(std::span<const PlacedScan> scans, const ExcuseOptions& options, RedTargets& red) {
  // Samples of each target, by scan.
  std::vector<std::uint32_t> first(red.targets.size() + 1, 0);
  for (const RedSampleRef& ref : red.samples) {
    ++first[ref.target + 1];
  }
  for (std::size_t i = 1; i < first.size(); ++i) {
    first[i] += first[i - 1];
  }
  for (const auto& group :
       cluster_targets(red, scans, 2.0 * red.cell_mm, 2.0 * options.largest_gap_mm, false)) {
    if (red.targets[group.front()].state != RegionState::kRed) {
      continue;
    }
    Eigen::AlignedBox3d box;
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_scan;
    for (const std::uint32_t t : group) {
      box.extend(red.targets[t].position_mm);
      if (box.diagonal().norm() > options.largest_gap_mm) {
        break;
      }
      for (std::uint32_t k = first[t]; k < first[t + 1]; ++k) {
        by_scan[red.samples[k].scan].push_back(red.samples[k].sample);
      }
    }
    if (box.diagonal().norm() > options.largest_gap_mm) {
      continue;
    }
    for (const auto& [scan, samples] : by_scan) {
      const auto fit = interpolate(scans[scan], samples, options);
      if (!fit || fit->width_mm > options.largest_gap_mm || fit->residual_mm > options.interpolation_mm ||
          fit->error_mm > options.interpolation_mm) {
        continue;
      }
      const std::string reason = describe(*fit, spacing_of(*scans[scan].grid));
      for (const std::uint32_t t : group) {
        set_excuse(red.targets[t], Excuse::kUnneeded, reason);
      }
      break;
    }
  }
}

void excuse_strays(std::span<const PlacedScan> scans, std::span<const double> noise_mm,
                   const ModelSurface& surface, const ExcuseOptions& options, RedTargets& red) {
  std::vector<ViewPredictor> views;
  double apart_mm = options.stray_mm;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    views.emplace_back(ScannerModel::of(*scans[s].grid, noise_mm[s]), scans[s].model_from_scanner,
                       surface.query, options.stray_mm);
    apart_mm = std::max(apart_mm, 2.0 * spacing_of(*scans[s].grid));
  }
  // A scan that made the return itself is no witness against it.
  std::vector<std::vector<std::uint32_t>> makers(red.targets.size());
  for (const RedSampleRef& ref : red.samples) {
    std::vector<std::uint32_t>& m = makers[ref.target];
    if (m.empty() || m.back() != ref.scan) {
      m.push_back(ref.scan);
    }
  }
  parallel_for_each_index(
      red.targets.size(),
      [&](std::size_t i) {
        RedTarget& target = red.targets[i];
        if (target.unseen || target.state != RegionState::kRed ||
            surface.query.closest(target.sample_mm.cast<float>(), static_cast<float>(apart_mm))) {
          return;
        }
        if (inside_clay(surface.query, target.sample_mm)) {
          set_excuse(target, Excuse::kUnneeded, "stray return: it lies inside the clay");
          target.area_mm2 = 0;
          return;
        }
        int past = 0;
        double nearest_mm = 0;
        for (std::uint32_t s = 0; s < views.size(); ++s) {
          if (std::binary_search(makers[i].begin(), makers[i].end(), s)) {
            continue;
          }
          const double behind_mm = views[s].looks_past_mm(target.sample_mm);
          if (behind_mm > 0) {
            nearest_mm = past == 0 ? behind_mm : std::min(nearest_mm, behind_mm);
            ++past;
          }
        }
        if (past >= options.stray_views) {
          std::array<char, 120> line{};
          std::snprintf(line.data(), line.size(),
                        "stray return in the air: %d scans look past it at the surface, %.1f mm behind", past,
                        nearest_mm);
          set_excuse(target, Excuse::kUnneeded, line.data());
          target.area_mm2 = 0;  // no surface is missing there
        }
      },
      16);
}

void excuse_out_of_reach(std::span<const float> best_chance, const ExcuseOptions& options, RedTargets& red) {
  for (std::size_t i = 0; i < red.targets.size(); ++i) {
    RedTarget& target = red.targets[i];
    if (target.state == RegionState::kRed && best_chance[i] >= 0 &&
        static_cast<double>(best_chance[i]) < options.least_chance) {
      set_excuse(target, Excuse::kUnreachable,
                 "no pose that the rig allows sees it with laser and camera at a slope below 70°");
    }
  }
}

void excuse_tried(double spacing_mm, const ExcuseOptions& options, RedTargets& red) {
  const double speck_mm2 = options.speck_spacings2 * spacing_mm * spacing_mm;
  for (RedTarget& target : red.targets) {
    const bool speck = !target.unseen && target.area_mm2 < speck_mm2;
    const int enough = speck ? options.speck_tries : options.tries;
    if (target.state == RegionState::kRed && target.tried.size() >= static_cast<std::size_t>(enough)) {
      set_excuse(target, Excuse::kUnreachable,
                 "at least " + std::to_string(enough) +
                     " scans looked at it and brought no dense samples: too deep, too dark or no surface");
    }
  }
}

}  // namespace dubsar
