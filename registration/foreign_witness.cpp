// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/foreign_witness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostSamples = 150000;
constexpr double kCellSpacings = 2.0;
/// Samples that a quick look takes, and the part of the least that is asked for there.
constexpr std::size_t kQuickSamples = 6000;
constexpr double kQuickShare = 0.5;
constexpr double kLeastQuick = 3.0;

/// So deep behind a sample lies what was seen through it. Of millions of samples of simulated tablets, with
/// holes and without, and of real scans, in their places, none was looked through by 0.4 mm; where a pose is
/// a little off, a rim may be.
constexpr double kInTheAirMm = 1.0;
constexpr double kInTheAirSpacings = 4.0;
constexpr double kInTheAirSigmas = 4.0;
constexpr int kInTheAirReach = 2;  ///< cells around a place that must all be seen through
constexpr int kNearReach = 1;      ///< the same beside what is foreign already
constexpr int kMissingReach = 2;   ///< cells around a place that must all be empty
constexpr float kFacing = 0.5F;    ///< cosine to the camera from which a scanner surely gets a return

/// Beyond how much two surfaces disagree.
constexpr double kBandSigmas = 4.0;
constexpr double kBandSpacings = 1.0;
constexpr double kLeastBandMm = 0.1;

/// A thing has so many samples and is so large; strays and mixed pixels are not.
constexpr double kLeastSamples = 60;
constexpr double kLeastMm2 = 3.0;

constexpr float kStepSpacings = 3.0F;  ///< a longer step to a neighbour is an edge in depth

/// Surfaces no farther apart than this, and turned alike, are taken for the same to tell how far apart they
/// lie.
constexpr float kSameMm = 3.0F;
constexpr float kSameNormals = 0.7F;

float in_the_air_mm(double spacing_mm, double apart_mm) {
  return static_cast<float>(
      std::max({kInTheAirMm, kInTheAirSpacings * spacing_mm, kInTheAirSigmas * kSigmaOfMedian * apart_mm}));
}

std::size_t quick_step(const RangeGrid& grid) {
  return std::max<std::size_t>(1, grid.size() / kQuickSamples);
}

}  // namespace

IntoOther::IntoOther(const ScanPose& from, const ScanPose& to) {
  const RigidTransform to_from = to.model_from_scanner.inverse() * from.model_from_scanner;
  rotation = to_from.rotation.cast<float>();
  shift_mm = to_from.translation_mm.cast<float>();
}

ForeignMatter::Witness::Witness(const RangeGrid& from, const SampleFlags& flags)
    : pins(from.pin_tip_diameter_mm > 0), up((-from.view.direction).cast<float>()) {
  while (from.size() / static_cast<std::size_t>(stride * stride) > kMostSamples) {
    ++stride;
  }
  grid.allocate((from.rows + stride - 1) / stride, (from.cols + stride - 1) / stride);
  grid.spacing_mm = from.spacing_mm * stride;
  grid.view.direction = from.view.direction;
  good.assign(grid.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::size_t at = from.index(grid.row_of(i) * stride, grid.col_of(i) * stride);
    if (from.valid[at] != 0 && (flags[at] & kNotTablet) == 0 && from.point(at).allFinite()) {
      grid.x[i] = from.x[at];
      grid.y[i] = from.y[at];
      grid.z[i] = from.z[at];
      grid.valid[i] = 1;
      good[i] = (flags[at] & kPotentiallySparse) == 0 ? 1 : 0;
    }
  }
  raster = DepthRaster(grid, kCellSpacings * grid.spacing_mm);
}

Eigen::Vector3f ForeignMatter::Witness::normal(std::size_t i) const {
  const int row = grid.row_of(i);
  const int col = grid.col_of(i);
  const Eigen::Vector3f p = grid.point(i);
  const float longest_mm = kStepSpacings * static_cast<float>(grid.spacing_mm);
  const auto along = [&](int down, int right) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const int sign : {1, -1}) {
      const int r = row + sign * down;
      const int c = col + sign * right;
      if (grid.is_valid(r, c)) {
        const Eigen::Vector3f step = grid.point(grid.index(r, c)) - p;
        sum += step.norm() <= longest_mm ? Eigen::Vector3f(static_cast<float>(sign) * step)
                                         : Eigen::Vector3f::Zero();
      }
    }
    return sum;
  };
  const Eigen::Vector3f n = along(1, 0).cross(along(0, 1));
  const float length = n.norm();
  return length > 0 ? Eigen::Vector3f((n.dot(up) < 0 ? -1.0F : 1.0F) / length * n) : Eigen::Vector3f::Zero();
}

std::size_t ForeignMatter::Witness::count(Matter what) const {
  return static_cast<std::size_t>(std::ranges::count(matter, what));
}

double ForeignMatter::Witness::least_in_the_air() const {
  return std::max(kLeastSamples, kLeastMm2 / (grid.spacing_mm * grid.spacing_mm));
}

bool ForeignMatter::Witness::is_looked_through(const Witness& other, const IntoOther& into) const {
  const std::size_t step = quick_step(grid);
  const double least = std::max(kLeastQuick, kQuickShare * least_in_the_air() / static_cast<double>(step));
  const auto stand_in_the_air = [&](float air_mm) {
    std::size_t in_the_air = 0;
    for (std::size_t i = 0; i < grid.size(); i += step) {
      in_the_air +=
          good[i] != 0 && other.raster.seen_through(into(grid.point(i)), air_mm, kInTheAirReach) ? 1 : 0;
    }
    return static_cast<double>(in_the_air) >= least;
  };
  const double mu_mm = other.grid.spacing_mm;
  return stand_in_the_air(in_the_air_mm(mu_mm, 0)) &&
         stand_in_the_air(in_the_air_mm(mu_mm, apart_mm(other, into)));
}

double ForeignMatter::Witness::apart_mm(const Witness& other, const IntoOther& into) const {
  std::vector<float> off_mm;
  const std::size_t step = quick_step(grid);
  for (std::size_t i = 0; i < grid.size(); i += step) {
    if (good[i] == 0) {
      continue;
    }
    const Eigen::Vector3f p = into(grid.point(i));
    const DepthRaster::Cell* cell = other.raster.at(p);
    if (cell == nullptr || cell->sample < 0) {
      continue;
    }
    const auto j = static_cast<std::size_t>(cell->sample);
    const Eigen::Vector3f apart = p - other.grid.point(j);
    const Eigen::Vector3f n = other.normal(j);
    if (std::abs(n.dot(apart)) <= kSameMm && n.dot(into.rotation * normal(i)) > kSameNormals) {
      off_mm.push_back(std::abs(n.dot(apart)));
    }
  }
  if (off_mm.empty()) {
    return 0;
  }
  return static_cast<double>(median_of(std::move(off_mm)));
}

std::size_t ForeignMatter::Witness::ask(const Witness& other, const IntoOther& into, double sigma_mm,
                                        std::vector<ForeignEvidence>& evidence) const {
  const double apart = apart_mm(other, into);
  const double sigmas_mm = kBandSigmas * std::max(sigma_mm, kSigmaOfMedian * apart);
  const auto band_mm =
      static_cast<float>(std::max({kLeastBandMm, kBandSpacings * other.grid.spacing_mm, sigmas_mm}));
  const float air_mm = in_the_air_mm(other.grid.spacing_mm, apart);
  const float far_mm = band_mm + static_cast<float>(2 * other.raster.cell_mm());
  std::vector<std::uint8_t> through(grid.size(), 0);
  parallel_for_each_index(grid.size(), [&](std::size_t i) {
    if (grid.valid[i] == 0) {
      return;
    }
    ForeignEvidence& e = evidence[i];
    const Eigen::Vector3f p = into(grid.point(i));
    const DepthRaster::Cell* cell = other.raster.at(p);
    if (cell == nullptr || cell->sample < 0) {
      e.free += other.raster.in_field(p) && other.raster.empty_around(p, kMissingReach) &&
                        (into.rotation * normal(i)).dot(other.up) > kFacing
                    ? 1
                    : 0;
      return;
    }
    const auto j = static_cast<std::size_t>(cell->sample);
    const Eigen::Vector3f away = p - other.grid.point(j);
    const Eigen::Vector3f n_other = other.normal(j);
    const float off_mm = n_other.isZero() ? away.norm() : std::abs(n_other.dot(away));
    if (off_mm <= band_mm && away.norm() <= far_mm) {
      const Eigen::Vector3f n = into.rotation * normal(i);
      const bool is_foreign = !other.matter.empty() && other.matter[j] == Matter::kForeign;
      const bool same_side = n.isZero() || n_other.isZero() || n.dot(n_other) > 0;
      e.shown += same_side && !is_foreign ? 1 : 0;
      return;
    }
    const float above_mm = other.raster.height(p) - other.raster.height(*cell);
    if (above_mm > band_mm) {
      e.front = true;
      e.free += other.raster.seen_through(p, band_mm, kNearReach) ? 1 : 0;
      through[i] = above_mm > air_mm && other.raster.seen_through(p, air_mm, kInTheAirReach) ? 1 : 0;
      e.through += through[i];
    }
  });
  return std::accumulate(through.begin(), through.end(), std::size_t{0});
}

}  // namespace dubsar
