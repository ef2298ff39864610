// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/relief.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/units.h"
#include "registration/scan_surface.h"

namespace dubsar {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kSameSide = 0.3F;    ///< cosine between normals of one neighbourhood
constexpr int kLeastAround = 8;      ///< cells that a neighbourhood must hold
constexpr float kCompatible = 0.7F;  ///< cosine between normals of one place in two scans
/// Correlations beyond this are taken as this: the rest is a matter of sampling.
constexpr double kMostCorrelation = 0.995;

float weight_at(float distance2, float radius2) {
  return std::max(0.0F, 1.0F - distance2 / radius2);
}

/// The usable cell nearest to p among those around the one that the camera saw straight at p; -1 when p is
/// off the surface.
std::int64_t descend(const SurfaceLevel& level, const Eigen::Vector3f& p, float band_mm) {
  const DepthRaster::Cell* cell = level.raster.at(p);
  if (cell == nullptr || cell->sample < 0 || std::abs(level.raster.height(p) - cell->height_mm) > band_mm) {
    return -1;
  }
  const RangeGrid& grid = level.grid;
  auto best = static_cast<std::size_t>(cell->sample);
  float best2 = (grid.point(best) - p).squaredNorm();
  for (int step = 0; step < 4; ++step) {
    const int row = grid.row_of(best);
    const int col = grid.col_of(best);
    const std::size_t from = best;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        if (grid.is_valid(row + dr, col + dc)) {
          const std::size_t j = grid.index(row + dr, col + dc);
          const float d2 = (grid.point(j) - p).squaredNorm();
          if (d2 < best2) {
            best2 = d2;
            best = j;
          }
        }
      }
    }
    if (best == from) {
      break;
    }
  }
  return static_cast<std::int64_t>(best);
}

/// The relief at p, near cell j, along the grid's own directions.
float interpolated(const SurfaceLevel& level, const Relief& relief, std::size_t j, const Eigen::Vector3f& p) {
  const RangeGrid& grid = level.grid;
  const Eigen::Vector3f d = p - grid.point(j);
  const int row = grid.row_of(j);
  const int col = grid.col_of(j);
  float value = relief.height_mm[j];
  for (const auto& [dr, dc] : {std::pair{1, 0}, std::pair{0, 1}}) {
    for (const int side : {1, -1}) {
      if (!grid.is_valid(row + side * dr, col + side * dc)) {
        continue;
      }
      const std::size_t k = grid.index(row + side * dr, col + side * dc);
      const Eigen::Vector3f e = grid.point(k) - grid.point(j);
      const float along = d.dot(e) / std::max(e.squaredNorm(), 1e-12F);
      if (along > 0 && !std::isnan(relief.height_mm[k])) {
        value += std::min(along, 0.5F) * (relief.height_mm[k] - relief.height_mm[j]);
        break;
      }
    }
  }
  return value;
}

}  // namespace

Relief make_relief(const SurfaceLevel& level, double radius_mm, std::size_t most_cells) {
  Relief out;
  out.radius_mm = radius_mm;
  const std::size_t count = level.grid.size();
  out.height_mm.assign(count, kUnknown);
  const auto radius = static_cast<float>(radius_mm);
  const float radius2 = radius * radius;
  std::vector<float> first(count, kUnknown);
  parallel_for_each_index(
      count,
      [&](std::size_t i) {
        if (level.usable[i] == 0) {
          return;
        }
        const Eigen::Vector3f p = level.grid.point(i);
        Eigen::Vector3f shift = Eigen::Vector3f::Zero();
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        float sum = 0;
        int around = 0;
        level.lookup->for_each_near(p, radius, [&](std::size_t j) {
          const Eigen::Vector3f d = level.grid.point(j) - p;
          const float w = weight_at(d.squaredNorm(), radius2);
          if (w > 0 && level.normals[j].dot(level.normals[i]) > kSameSide) {
            shift += w * d;
            normal += w * level.normals[j];
            sum += w;
            ++around;
          }
        });
        if (around >= kLeastAround && normal.norm() > 1e-3F * sum) {
          first[i] = -normal.normalized().dot(shift / sum);
        }
      },
      128);
  // The body bends: its bend, alike all around, is taken off again.
  parallel_for_each_index(
      count,
      [&](std::size_t i) {
        if (std::isnan(first[i])) {
          return;
        }
        const Eigen::Vector3f p = level.grid.point(i);
        float total = 0;
        float sum = 0;
        level.lookup->for_each_near(p, radius, [&](std::size_t j) {
          const float w = weight_at((level.grid.point(j) - p).squaredNorm(), radius2);
          if (w > 0 && !std::isnan(first[j])) {
            total += w * first[j];
            sum += w;
          }
        });
        // A fold or another sheet is no relief; one such place must not outweigh all others.
        out.height_mm[i] = std::clamp(first[i] - total / sum, -0.25F * radius, 0.25F * radius);
      },
      128);
  std::vector<std::uint32_t> known;
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isnan(out.height_mm[i])) {
      known.push_back(static_cast<std::uint32_t>(i));
      square += static_cast<double>(out.height_mm[i]) * static_cast<double>(out.height_mm[i]);
    }
  }
  if (known.empty()) {
    return out;
  }
  out.rms_mm = std::sqrt(square / static_cast<double>(known.size()));
  const std::size_t sent = std::min(known.size(), most_cells);
  for (std::size_t k = 0; k < sent; ++k) {
    out.cells.push_back(known[(2 * k + 1) * known.size() / (2 * sent)]);
  }
  out.cell_area_mm2 =
      level.spacing_mm * level.spacing_mm * static_cast<double>(known.size()) / static_cast<double>(sent);
  return out;
}

double ReliefAgreement::correlation() const {
  if (pairs < 8) {
    return 0;
  }
  const double vs = ss - s * s / pairs;
  const double vt = tt - t * t / pairs;
  return vs > 0 && vt > 0 ? (st - s * t / pairs) / std::sqrt(vs * vt) : 0.0;
}

double ReliefAgreement::significance(double radius_mm) const {
  // What stands within half a radius belongs together.
  const double places = area_mm2 / (kPi * 0.25 * radius_mm * radius_mm);
  const double rho = std::clamp(correlation(), -kMostCorrelation, kMostCorrelation);
  return std::atanh(rho) * std::sqrt(std::max(0.0, places - 3.0));
}

ReliefAgreement relief_agreement(const SurfaceLevel& source, const Relief& source_relief,
                                 const SurfaceLevel& target, const Relief& target_relief,
                                 const RigidTransform& target_from_source, double tolerance_mm) {
  ReliefAgreement out;
  const Eigen::Matrix3f rotation = target_from_source.rotation.cast<float>();
  const Eigen::Vector3f shift = target_from_source.translation_mm.cast<float>();
  const auto tolerance = static_cast<float>(tolerance_mm);
  const float band = 3.0F * tolerance + static_cast<float>(target.spacing_mm);
  for (const std::uint32_t i : source_relief.cells) {
    const Eigen::Vector3f p = rotation * source.grid.point(i) + shift;
    const std::int64_t found = descend(target, p, band);
    if (found < 0) {
      continue;
    }
    const auto j = static_cast<std::size_t>(found);
    const float off = std::abs(target.normals[j].dot(p - target.grid.point(j)));
    if (std::isnan(target_relief.height_mm[j]) ||
        (rotation * source.normals[i]).dot(target.normals[j]) < kCompatible || off > tolerance) {
      continue;
    }
    const auto a = static_cast<double>(source_relief.height_mm[i]);
    const auto b = static_cast<double>(interpolated(target, target_relief, j, p));
    out.pairs += 1;
    out.s += a;
    out.t += b;
    out.ss += a * a;
    out.tt += b * b;
    out.st += a * b;
  }
  out.area_mm2 = out.pairs * source_relief.cell_area_mm2;
  return out;
}

}  // namespace dubsar
