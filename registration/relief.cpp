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
constexpr float kSameSide = 0.3F;  ///< cosine between normals of one neighbourhood
/// Of the length of the mean normal of all around, 1 where they are parallel: at a sharp rim below 0.85, and
/// 0.9 where it begins to stand above its surroundings.
constexpr float kLeastAlike = 0.92F;
constexpr int kLeastAround = 8;      ///< cells that a neighbourhood must hold
constexpr float kCompatible = 0.7F;  ///< cosine between normals of one place in two scans
/// Correlations beyond this are taken as this: the rest is a matter of sampling.
constexpr double kMostCorrelation = 0.995;
constexpr float kLeastIntensity = 1.0F / 512.0F;  ///< darker is dark

float weight_at(float distance2, float radius2) {
  return std::max(0.0F, 1.0F - distance2 / radius2);
}

/// The usable cell nearest to p among those around the one that the camera saw straight at p; -1 when p is
/// off the surface.
std::int64_t descend(const SurfaceLevel& level, const Eigen::Vector3f& p, float band_mm) {
  const DepthRaster::Cell* cell = level.raster.at(p);
  if (cell == nullptr || cell->sample < 0 ||
      std::abs(level.raster.height(p) - level.raster.height(*cell)) > band_mm) {
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

/// The value at p, near cell j, along the grid's own directions.
float interpolated(const SurfaceLevel& level, const std::vector<float>& values, std::size_t j,
                   const Eigen::Vector3f& p) {
  const RangeGrid& grid = level.grid;
  const Eigen::Vector3f d = p - grid.point(j);
  const int row = grid.row_of(j);
  const int col = grid.col_of(j);
  float value = values[j];
  for (const auto& [dr, dc] : {std::pair{1, 0}, std::pair{0, 1}}) {
    for (const int side : {1, -1}) {
      if (!grid.is_valid(row + side * dr, col + side * dc)) {
        continue;
      }
      const std::size_t k = grid.index(row + side * dr, col + side * dc);
      const Eigen::Vector3f e = grid.point(k) - grid.point(j);
      const float along = d.dot(e) / std::max(e.squaredNorm(), 1e-12F);
      if (along > 0 && !std::isnan(values[k])) {
        value += std::min(along, 0.5F) * (values[k] - values[j]);
        break;
      }
    }
  }
  return value;
}

/// Each known value less the mean of those in its neighbourhood.
std::vector<float> less_surroundings(const SurfaceLevel& level, const std::vector<float>& values,
                                     float radius) {
  std::vector<float> out(values.size(), kUnknown);
  const float radius2 = radius * radius;
  parallel_for_each_index(
      values.size(),
      [&](std::size_t i) {
        if (std::isnan(values[i])) {
          return;
        }
        const Eigen::Vector3f p = level.grid.point(i);
        float total = 0;
        float sum = 0;
        level.lookup->for_each_near(p, radius, [&](std::size_t j) {
          const float w = weight_at((level.grid.point(j) - p).squaredNorm(), radius2);
          if (w > 0 && !std::isnan(values[j])) {
            total += w * values[j];
            sum += w;
          }
        });
        out[i] = values[i] - total / sum;  // it is in its own neighbourhood
      },
      128);
  return out;
}

/// Takes the mean of each column and then of each row off.
void take_off_lines(const RangeGrid& grid, std::vector<float>& values) {
  const auto along = [&](int lines, int length, const auto& index) {
    for (int line = 0; line < lines; ++line) {
      double sum = 0;
      int known = 0;
      for (int k = 0; k < length; ++k) {
        const float value = values[index(line, k)];
        if (!std::isnan(value)) {
          sum += static_cast<double>(value);
          ++known;
        }
      }
      for (int k = 0; k < length && known > 0; ++k) {
        values[index(line, k)] -= static_cast<float>(sum / known);
      }
    }
  };
  along(grid.cols, grid.rows, [&](int col, int row) { return grid.index(row, col); });
  along(grid.rows, grid.cols, [&](int row, int col) { return grid.index(row, col); });
}

double rms_of(const std::vector<float>& values) {
  double square = 0;
  std::size_t known = 0;
  for (const float value : values) {
    if (!std::isnan(value)) {
      square += static_cast<double>(value) * static_cast<double>(value);
      ++known;
    }
  }
  return known > 0 ? std::sqrt(square / static_cast<double>(known)) : 0.0;
}

}  // namespace

Relief make_relief(const SurfaceLevel& level, const std::vector<float>& intensity, double radius_mm,
                   std::size_t most_cells) {
  Relief out;
  out.radius_mm = radius_mm;
  const std::size_t count = level.grid.size();
  out.height_mm.assign(count, kUnknown);
  out.at_rim.assign(count, 0);
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
        Eigen::Vector3f every = Eigen::Vector3f::Zero();
        float whole = 0;
        level.lookup->for_each_near(p, radius, [&](std::size_t j) {
          const Eigen::Vector3f d = level.grid.point(j) - p;
          const float w = weight_at(d.squaredNorm(), radius2);
          every += w * level.normals[j];
          whole += w;
          if (w > 0 && level.normals[j].dot(level.normals[i]) > kSameSide) {
            shift += w * d;
            normal += w * level.normals[j];
            sum += w;
            ++around;
          }
        });
        if (around >= kLeastAround && normal.norm() > 1e-3F * sum) {
          first[i] = -normal.normalized().dot(shift / sum);
          out.at_rim[i] = every.norm() < kLeastAlike * whole ? 1 : 0;
        }
      },
      128);
  // The body bends: its bend, alike all around, is taken off again. A fold or another sheet is no relief; one
  // such place must not outweigh all others.
  out.height_mm = less_surroundings(level, first, radius);
  for (float& height : out.height_mm) {
    height = std::clamp(height, -0.25F * radius, 0.25F * radius);
  }
  if (!intensity.empty()) {
    std::vector<float> light(count, kUnknown);
    for (std::size_t i = 0; i < count; ++i) {
      if (level.usable[i] != 0 && intensity[i] > 0) {
        light[i] = std::log(std::max(intensity[i], kLeastIntensity));
      }
    }
    out.tone = less_surroundings(level, light, radius);
    take_off_lines(level.grid, out.tone);
    out.tone_rms = rms_of(out.tone);
  }
  out.rms_mm = rms_of(out.height_mm);
  std::vector<std::uint32_t> known;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isnan(out.height_mm[i])) {
      known.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (known.empty()) {
    return out;
  }
  const std::size_t sent = std::min(known.size(), most_cells);
  for (std::size_t k = 0; k < sent; ++k) {
    out.cells.push_back(known[(2 * k + 1) * known.size() / (2 * sent)]);
  }
  out.cell_area_mm2 =
      level.spacing_mm * level.spacing_mm * static_cast<double>(known.size()) / static_cast<double>(sent);
  return out;
}

double Correlation::value() const {
  if (n < 8) {
    return 0;
  }
  const double vs = ss - s * s / n;
  const double vt = tt - t * t / n;
  return vs > 0 && vt > 0 ? (st - s * t / n) / std::sqrt(vs * vt) : 0.0;
}

double ReliefAgreement::together(const Correlation& by_height, double radius_mm) const {
  const auto deviations = [&](const Correlation& c) {
    const double rho = std::clamp(c.value(), -kMostCorrelation, kMostCorrelation);
    const double share = height.n > 0 ? c.n / height.n : 0.0;
    return std::atanh(rho) * std::sqrt(std::max(0.0, share * places(radius_mm) - 3.0));
  };
  const double of_height = deviations(by_height);
  const double of_tone = deviations(tone);
  return of_tone <= 0 ? of_height : std::hypot(std::max(of_height, 0.0), of_tone);
}

double ReliefAgreement::significance(double radius_mm) const {
  return together(height, radius_mm);
}

double ReliefAgreement::significance_off_rims(double radius_mm) const {
  return together(off_rims, radius_mm);
}

double ReliefAgreement::places(double radius_mm) const {
  // What stands within half a radius belongs together.
  return area_mm2 / (kPi * 0.25 * radius_mm * radius_mm);
}

double ReliefAgreement::correlation() const {
  return std::max(height.value(), tone.value());
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
    const auto there_mm = static_cast<double>(interpolated(target, target_relief.height_mm, j, p));
    out.height.add(static_cast<double>(source_relief.height_mm[i]), there_mm);
    if (source_relief.at_rim[i] == 0 && target_relief.at_rim[j] == 0) {
      out.off_rims.add(static_cast<double>(source_relief.height_mm[i]), there_mm);
    }
    if (!source_relief.tone.empty() && !target_relief.tone.empty() && !std::isnan(source_relief.tone[i]) &&
        !std::isnan(target_relief.tone[j])) {
      out.tone.add(static_cast<double>(source_relief.tone[i]),
                   static_cast<double>(interpolated(target, target_relief.tone, j, p)));
    }
  }
  out.area_mm2 = out.height.n * source_relief.cell_area_mm2;
  return out;
}

}  // namespace dubsar
