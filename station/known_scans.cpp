// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/known_scans.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <string_view>

#include "core/units.h"

namespace dubsar {

namespace {

/// Of a scan's size, and of how far its coordinates reach: what rounding does to a float, and noise exceeds.
constexpr double kSameWithin = 1e-5;
constexpr double kRounding = 5e-7;
/// Of the larger box's size. Six numbers that keep to a unit's factor so closely are no chance, and what a
/// resampling of other numbers does to the rim is less.
constexpr double kSameBoxWithin = 0.01;

Eigen::AlignedBox3d box_of(const RangeGrid& grid) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      box.extend(grid.point(i).cast<double>());
    }
  }
  return box;
}

}  // namespace

bool same_samples(const RangeGrid& a, const RangeGrid& b) {
  if (a.rows != b.rows || a.cols != b.cols || a.valid != b.valid) {
    return false;
  }
  const Eigen::AlignedBox3d box = box_of(a);
  if (box.isEmpty()) {
    return true;
  }
  const double within_mm = kSameWithin * box.diagonal().norm() +
                           kRounding * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.valid[i] != 0 && !((a.point(i) - b.point(i)).cast<double>().norm() <= within_mm)) {
      return false;
    }
  }
  return true;
}

std::optional<double> unit_between(const RangeGrid& stored, const RangeGrid& came) {
  const Eigen::AlignedBox3d had = box_of(stored);
  const Eigen::AlignedBox3d has = box_of(came);
  if (had.isEmpty() || has.isEmpty()) {
    return std::nullopt;
  }
  for (const std::string_view now : kLengthUnits) {
    for (const std::string_view then : kLengthUnits) {
      const double factor = *mm_per_unit(now) / *mm_per_unit(then);
      const double within_mm = kSameBoxWithin * has.diagonal().norm();
      if (now != then && (has.min() - factor * had.min()).norm() <= within_mm &&
          (has.max() - factor * had.max()).norm() <= within_mm) {
        return factor;
      }
    }
  }
  return std::nullopt;
}

void KnownScans::add(const StoredScan& scan, const RangeGrid* grid) {
  if (!scan.source.empty()) {
    by_name_[scan.source].push_back({scan.id, scan.samples, scan.dropped,
                                     grid != nullptr ? sample_digest(*grid) : std::optional<SampleDigest>()});
  }
}

KnownAs KnownScans::find(const RangeGrid& came, const GridOf& stored) const {
  const auto named = by_name_.find(came.source);
  if (came.source.empty() || named == by_name_.end()) {
    return {};
  }
  const std::optional<SampleDigest> digest = sample_digest(came);
  const auto samples = static_cast<std::int64_t>(came.valid_count());
  for (const One& one : named->second) {
    if (digest && one.digest == digest) {
      return {KnownAs::Kind::kSame, one.id};
    }
  }
  KnownAs other{KnownAs::Kind::kNamesake, named->second.front().id};
  for (const One& one : named->second) {
    const Result<RangeGrid> grid = stored(one.id);
    if (grid ? same_samples(*grid, came) : one.samples == samples) {
      return {KnownAs::Kind::kSame, one.id};
    }
    // One that was taken out may come again in its right unit.
    if (const auto factor = grid && !one.dropped ? unit_between(*grid, came) : std::nullopt) {
      other = {KnownAs::Kind::kOtherUnit, one.id, *factor};
    }
  }
  return other;
}

}  // namespace dubsar
