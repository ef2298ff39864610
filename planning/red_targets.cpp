// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_targets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/parallel.h"
#include "planning/clearing.h"
#include "planning/clusters.h"
#include "planning/spacing_levels.h"
#include "planning/sparse_flags.h"

namespace dubsar {

namespace {

/// Cells that a gap may have: far more than the longest one has at any spacing, for where the far rim is not
/// found the near one counts as the border of what was seen.
constexpr double kMostReach = 1e6;

/// One red sample, model frame.
struct Red {
  std::uint32_t scan = 0;
  std::uint32_t sample = 0;
  Eigen::Vector3d position_mm{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 0};  ///< weighted by area
  Eigen::Vector3d sample_mm{0, 0, 0};
  double area_mm2 = 0;
  std::uint8_t level = 0;  ///< of its scan's spacing
  std::array<std::int32_t, 3> cell{};
};

class GapReader {
 public:
  GapReader(const PlacedScan& scan, double longest_gap_mm)
      : grid_(*scan.grid),
        flags_(*scan.flags),
        spacing_mm_(std::max(spacing_of(*scan.grid), 1e-9)),
        longest_gap_mm_(longest_gap_mm),
        reach_(static_cast<int>(std::clamp(longest_gap_mm / spacing_mm_, 2.0, kMostReach))) {}

  /// Area, normal and place (scanner frame) of what is missing around a sample.
  void read(std::size_t i, Eigen::Vector3d& position, Eigen::Vector3d& normal, double& area) const {
    const int row = grid_.row_of(i);
    const int col = grid_.col_of(i);
    const Eigen::Vector3d p = grid_.point(i).cast<double>();
    const Eigen::Vector3d to_camera = grid_.view.to_camera(p, row);
    const auto step_mm = static_cast<float>(5.0 * spacing_mm_);
    Eigen::Vector3d own = sample_normal(grid_, i, step_mm).cast<double>();
    if (own.isZero()) {
      own = to_camera;
    }
    // The sample itself is badly sampled ground, whatever lies around it.
    area = 0.25 * spacing_mm_ * spacing_mm_;
    normal = area * own;
    position = area * p;
    for (const auto& [dr, dc] : {std::pair{0, 1}, {0, -1}, {1, 0}, {-1, 0}}) {
      add_gap(row, col, dr, dc, p, own, to_camera, position, normal, area);
    }
    position /= area;
  }

 private:
  [[nodiscard]] bool there(int row, int col) const {
    return grid_.is_valid(row, col) && (flags_[grid_.index(row, col)] & kNotTablet) == 0;
  }

  void add_gap(int row, int col, int dr, int dc, const Eigen::Vector3d& p, const Eigen::Vector3d& own,
               const Eigen::Vector3d& to_camera, Eigen::Vector3d& position, Eigen::Vector3d& normal,
               double& area) const {
    int k = 1;
    while (k <= reach_ && grid_.inside(row + k * dr, col + k * dc) && !there(row + k * dr, col + k * dc)) {
      ++k;
    }
    if (k <= reach_ && there(row + k * dr, col + k * dc)) {
      const Eigen::Vector3d q = grid_.point(grid_.index(row + k * dr, col + k * dc)).cast<double>();
      const Eigen::Vector3d gap = q - p;
      const double length = gap.norm();
      if (length <= kGapInSpacings * spacing_mm_) {
        return;
      }
      if (length <= longest_gap_mm_) {
        // Half of half the gap: the other rim has the other half, rows and columns share the hole.
        const double part = 0.25 * spacing_mm_ * length;
        const Eigen::Vector3d along = gap / length;
        const Eigen::Vector3d across = to_camera - along * along.dot(to_camera);
        if (across.norm() > 1e-6) {
          normal += part * across.normalized();
          position += part * (p + 0.25 * gap);
          area += part;
        }
        return;
      }
    }
    // The border of what was seen. The surface goes on there, turning away from the scanner.
    if (!there(row - dr, col - dc)) {
      return;
    }
    const Eigen::Vector3d back = grid_.point(grid_.index(row - dr, col - dc)).cast<double>() - p;
    const Eigen::Vector3d outward = -(back - to_camera * to_camera.dot(back));
    if (outward.norm() > 1e-9) {
      const double part = 0.5 * spacing_mm_ * spacing_mm_;
      normal += part * (own + 0.7 * outward.normalized()).normalized();
      position += part * p;
      area += part;
    }
  }

  const RangeGrid& grid_;
  const SampleFlags& flags_;
  double spacing_mm_;
  double longest_gap_mm_;
  int reach_;
};

std::vector<Red> red_samples(std::span<const PlacedScan> scans, const SpacingLevels& levels,
                             double longest_gap_mm) {
  std::vector<Red> reds;
  for (std::uint32_t s = 0; s < scans.size(); ++s) {
    const RangeGrid& grid = *scans[s].grid;
    const std::size_t first = reds.size();
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (is_red((*scans[s].flags)[i]) && grid.valid[i] != 0 && grid.point(i).allFinite()) {
        Red red;
        red.scan = s;
        red.level = levels.of_scan(s);
        red.sample = static_cast<std::uint32_t>(i);
        reds.push_back(red);
      }
    }
    const GapReader reader(scans[s], longest_gap_mm);
    const RigidTransform& pose = scans[s].model_from_scanner;
    parallel_for_each_index(
        reds.size() - first,
        [&](std::size_t k) {
          Red& red = reds[first + k];
          Eigen::Vector3d position;
          Eigen::Vector3d normal;
          reader.read(red.sample, position, normal, red.area_mm2);
          red.position_mm = pose * position;
          red.sample_mm = pose * grid.point(red.sample).cast<double>();
          red.normal = pose.rotation * normal;
        },
        512);
  }
  return reds;
}

bool share_cell(const Red& a, const Red& b) {
  return a.level == b.level && a.cell == b.cell;
}

/// Sorts the samples by level and cell of space; returns the number of cells. cells_mm: by level.
std::size_t sort_into_cells(std::vector<Red>& reds, std::span<const double> cells_mm) {
  for (Red& red : reds) {
    const double cell_mm = cells_mm[red.level];
    for (int k = 0; k < 3; ++k) {
      red.cell[static_cast<std::size_t>(k)] =
          static_cast<std::int32_t>(std::clamp(std::floor(red.position_mm[k] / cell_mm), -1.0e9, 1.0e9));
    }
  }
  std::sort(reds.begin(), reds.end(), [](const Red& a, const Red& b) {
    return std::tie(a.level, a.cell, a.scan, a.sample) < std::tie(b.level, b.cell, b.scan, b.sample);
  });
  std::size_t cells = 0;
  for (std::size_t i = 0; i < reds.size(); ++i) {
    cells += i == 0 || !share_cell(reds[i], reds[i - 1]) ? 1 : 0;
  }
  return cells;
}

RedTarget merged(std::span<const Red> reds) {
  RedTarget target;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double total = 0;
  double of_scan = 0;
  for (std::size_t i = 0; i < reds.size(); ++i) {
    of_scan = i > 0 && reds[i].scan == reds[i - 1].scan ? of_scan + reds[i].area_mm2 : reds[i].area_mm2;
    target.area_mm2 = std::max(target.area_mm2, of_scan);
    position += reds[i].area_mm2 * reds[i].position_mm;
    normal += reds[i].normal;
    total += reds[i].area_mm2;
    target.sample_mm += reds[i].sample_mm / static_cast<double>(reds.size());
  }
  target.position_mm = position / total;
  target.normal = normal.norm() > 0.05 * total ? normal.normalized() : reds.front().normal.normalized();
  return target;
}

}  // namespace

RedTargets red_targets(std::span<const PlacedScan> scans, const ModelSurface& surface,
                       const RedTargetOptions& options) {
  RedTargets out;
  const SpacingLevels levels(scans);
  std::vector<Red> reds = red_samples(scans, levels, options.longest_gap_mm);
  std::vector<double> cells_mm;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    cells_mm.push_back(std::max(options.cell_mm, 3.0 * levels.spacing_mm(level)));
  }
  while (sort_into_cells(reds, cells_mm) > options.max_targets) {
    std::ranges::for_each(cells_mm, [](double& cell_mm) { cell_mm *= 1.5; });
  }
  out.cell_mm = cells_mm.back();
  for (std::size_t begin = 0; begin < reds.size();) {
    std::size_t end = begin + 1;
    while (end < reds.size() && share_cell(reds[end], reds[begin])) {
      ++end;
    }
    for (std::size_t i = begin; i < end; ++i) {
      out.samples.push_back({reds[i].scan, reds[i].sample, static_cast<std::uint32_t>(out.targets.size())});
    }
    out.targets.push_back(merged(std::span(reds).subspan(begin, end - begin)));
    out.targets.back().cell_share = cells_mm[reds[begin].level] / out.cell_mm;
    begin = end;
  }
  for (const SurfacePatch& patch : surface.unseen) {
    RedTarget target;
    target.position_mm = patch.position_mm;
    target.sample_mm = patch.position_mm;
    target.normal = patch.normal;
    target.area_mm2 = patch.area_mm2;
    target.unseen = true;
    target.cell_share = cells_mm.front() / out.cell_mm;
    out.targets.push_back(std::move(target));
  }
  return out;
}

void drop_unbordered_patches(std::span<const PlacedScan> scans, bool is_closed, RedTargets& red) {
  constexpr double kLargestSlitMm2 = 10.0;
  constexpr double kLeastShareOfBorder = 0.25;
  double patch_mm = 0;
  for (const RedTarget& t : red.targets) {
    patch_mm = t.unseen && !t.rim ? std::max(patch_mm, std::sqrt(t.area_mm2)) : patch_mm;
  }
  const double spacing_mm = coarsest_spacing_mm(scans);
  std::vector<std::size_t> samples(red.targets.size(), 0);
  for (const RedSampleRef& ref : red.samples) {
    ++samples[ref.target];
  }
  std::vector<std::uint8_t> drop(red.targets.size(), 0);
  for (const auto& group : cluster_targets(red, scans, 2.0 * red.cell_mm, 0.0, true, 1.8 * patch_mm)) {
    double area = 0;
    std::size_t border = 0;
    for (const std::uint32_t i : group) {
      area += red.targets[i].unseen && !red.targets[i].rim ? red.targets[i].area_mm2 : 0.0;
      border += red.targets[i].rim ? 1 : samples[i];
    }
    const double perimeter = 4.0 * std::sqrt(area) / std::max(spacing_mm, 1e-9);
    const bool has_border = static_cast<double>(border) >= kLeastShareOfBorder * perimeter;
    if (area > kLargestSlitMm2 ? !is_closed || border > 0 : has_border) {
      continue;
    }
    for (const std::uint32_t i : group) {
      drop[i] = red.targets[i].unseen && !red.targets[i].rim ? 1 : 0;
    }
  }
  std::vector<RedTarget> kept;
  for (std::size_t i = 0; i < red.targets.size(); ++i) {
    if (drop[i] == 0) {
      kept.push_back(std::move(red.targets[i]));
    }
  }
  red.targets = std::move(kept);
}

}  // namespace dubsar
