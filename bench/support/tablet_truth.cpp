// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/tablet_truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/grid_lookup.h"
#include "core/parallel.h"
#include "core/rig.h"
#include "core/units.h"
#include "planning/clusters.h"
#include "planning/sparse_flags.h"
#include "sim/reachable.h"

namespace dubsar::bench {

namespace {

/// Poses of the rig, for each of the six sides that the tablet can lie on.
constexpr std::size_t kTurns = 36;
constexpr std::size_t kTilts = 9;
constexpr std::size_t kPoses = 6 * kTurns * kTilts;
constexpr float kGroupMm = 0.6F;
constexpr std::size_t kLeastGroup = 4;

}  // namespace

TabletTruth::TabletTruth(const sim::SimTablet& tablet, const MeshQuery& query,
                         const sim::ScannerOptions& scanner, double tilt_max_deg, std::size_t points)
    : tablet_(&tablet),
      query_(&query),
      scanner_(scanner),
      tilt_max_rad_(rad_from_deg(tilt_max_deg)),
      area_mm2_(surface_area_mm2(tablet.mesh)) {
  sim::spread_over(tablet.mesh, points, 1, &points_, &normals_);
}

std::vector<std::uint8_t> TabletTruth::sampled_by(const PlacedScan& scan) const {
  std::vector<std::uint32_t> all(points_.size());
  std::iota(all.begin(), all.end(), 0U);
  return sampled_points(scan, all);
}

std::vector<std::uint8_t> TabletTruth::sampled_points(const PlacedScan& scan,
                                                      const std::vector<std::uint32_t>& which) const {
  std::vector<std::uint8_t> keep(scan.grid->size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) ? 1 : 0;
  }
  const GridLookup lookup(*scan.grid, keep);
  const RigidTransform scanner_from_model = scan.model_from_scanner.inverse();
  const auto radius_mm = static_cast<float>(1.5 * scanner_.spacing_mm + 3 * scanner_.noise_mm);
  std::vector<std::uint8_t> sampled(which.size());
  parallel_for_each_index(which.size(), [&](std::size_t k) {
    const Eigen::Vector3f p = (scanner_from_model * points_[which[k]].cast<double>().eval()).cast<float>();
    sampled[k] = lookup.nearest(p, radius_mm) >= 0 ? 1 : 0;
  });
  return sampled;
}

std::vector<std::uint8_t> TabletTruth::unreachable(const std::vector<std::uint8_t>& sampled,
                                                   JobContext& job) const {
  std::vector<std::size_t> open;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    if (sampled[i] == 0) {
      open.push_back(i);
      points.push_back(points_[i]);
      normals.push_back(normals_[i]);
    }
  }
  const auto reachable = sim::reachable_points(points, normals, *query_, scanner_, {}, job);
  std::vector<std::uint8_t> out(sampled.size(), 0);
  std::vector<std::uint32_t> by_rays;
  for (std::size_t k = 0; reachable && k < open.size(); ++k) {
    if ((*reachable)[k] == 0) {
      out[open[k]] = 1;
    } else {
      by_rays.push_back(static_cast<std::uint32_t>(open[k]));
    }
  }
  UnionFind sets(by_rays.size());
  for (std::uint32_t a = 0; a < by_rays.size(); ++a) {
    for (std::uint32_t b = a + 1; b < by_rays.size(); ++b) {
      if ((points_[by_rays[a]] - points_[by_rays[b]]).squaredNorm() < kGroupMm * kGroupMm) {
        sets.join(a, b);
      }
    }
  }
  for (const auto& group : sets.groups()) {
    if (group.size() >= kLeastGroup) {
      std::vector<std::uint32_t> of_points;
      for (const std::uint32_t k : group) {
        of_points.push_back(by_rays[k]);
      }
      scan_from_everywhere(of_points, out);
    }
  }
  return out;
}

void TabletTruth::scan_from_everywhere(const std::vector<std::uint32_t>& group,
                                       std::vector<std::uint8_t>& unreachable) const {
  Eigen::AlignedBox3f box;
  for (const std::uint32_t i : group) {
    box.extend(points_[i]);
  }
  const Eigen::Vector3d center = box.center().cast<double>();
  sim::ScannerOptions window = scanner_;
  const double margin_mm = 8 * scanner_.spacing_mm;
  window.field_x_mm = window.field_y_mm = static_cast<double>(box.diagonal().norm()) + 2 * margin_mm;
  window.margin_mm = 0;
  const sim::TriangulationScanner scanner(window);
  const sim::Scene scene{tablet_, query_, {}, std::nullopt};
  std::vector<std::vector<std::uint8_t>> seen(kPoses);
  parallel_for_each_index(
      kPoses,
      [&](std::size_t d) {
        // The tablet on one of its sides, turntable and tilt in steps.
        const auto side = static_cast<int>(d / (kTurns * kTilts));
        const double turn = 2 * kPi * static_cast<double>(d / kTilts % kTurns) / kTurns;
        const double tilt = tilt_max_rad_ * static_cast<double>(d % kTilts) / (kTilts - 1);
        Eigen::Vector3d up = Eigen::Vector3d::Zero();
        up[side / 2] = side % 2 == 0 ? 1 : -1;
        RigidTransform pose;
        pose.rotation =
            Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix().transpose() *
            stage_from_scanner(turn, tilt, Eigen::Vector3d::Zero()).rotation;
        pose.translation_mm = center;
        const Eigen::Vector3d from = pose.rotation.col(2);
        const bool any = std::any_of(group.begin(), group.end(), [&](std::uint32_t i) {
          const Eigen::Vector3f p = points_[i] + 0.02F * normals_[i];
          return normals_[i].dot(from.cast<float>()) > 0.2F &&
                 !query_->occluded(p, p + 200.0F * from.cast<float>(), 0.01F);
        });
        if (!any) {
          return;
        }
        JobContext quiet;
        const auto grid = scanner.scan_grid(scene, pose, d, quiet);
        if (!grid || grid->size() == 0) {
          return;
        }
        const SampleFlags flags = flag_sparse(*grid);
        seen[d] = sampled_points({0, &*grid, &flags, pose, 0}, group);
      },
      1);
  for (std::size_t k = 0; k < group.size(); ++k) {
    unreachable[group[k]] = 1;
    for (const auto& by_direction : seen) {
      if (!by_direction.empty() && by_direction[k] != 0) {
        unreachable[group[k]] = 0;
      }
    }
  }
}

TabletTruth::Share TabletTruth::share_of_reachable(const std::vector<std::uint8_t>& sampled,
                                                   JobContext& job) const {
  const std::vector<std::uint8_t> out_of_reach = unreachable(sampled, job);
  const auto slit_mm = static_cast<float>(3.0 * scanner_.spacing_mm);
  std::size_t open = 0;
  std::size_t in_slits = 0;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    if (sampled[i] == 0 && out_of_reach[i] == 0) {
      ++open;
      in_slits += query_->first_hit(points_[i], normals_[i], 0.02F, slit_mm) ? 1 : 0;
    }
  }
  const auto good = static_cast<double>(std::count(sampled.begin(), sampled.end(), 1));
  const auto of = [&](std::size_t missing) {
    return good > 0 ? good / (good + static_cast<double>(missing)) : 1.0;
  };
  return {of(open), of(open - in_slits)};
}

ExcuseScore TabletTruth::judge(const std::vector<RedTarget>& targets, const RigidTransform& tablet_from_model,
                               double cell_mm, const std::vector<std::uint8_t>& sampled,
                               JobContext& job) const {
  const std::vector<std::uint8_t> out_of_reach = unreachable(sampled, job);
  ExcuseScore score;
  for (const RedTarget& t : targets) {
    if (t.state != RegionState::kExcused) {
      continue;
    }
    const Eigen::Vector3f p = (tablet_from_model * t.position_mm).cast<float>();
    if (t.excuse == Excuse::kUnneeded) {
      score.unneeded_mm2 += t.area_mm2;
      if (t.area_mm2 > 0) {
        const Eigen::Vector3f filled =
            (tablet_from_model * t.interpolated_mm.value_or(t.position_mm)).cast<float>();
        const auto surface = query_->closest(filled, 10.0F);
        score.interpolation_error_mm.push_back(surface ? surface->distance_mm : 10.0);
      }
      continue;
    }
    score.unreachable_mm2 += t.area_mm2;
    const double reach_mm = std::max(cell_mm, std::sqrt(t.area_mm2));
    std::size_t open = 0;
    std::size_t never = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (sampled[i] == 0 && (points_[i] - p).squaredNorm() <= static_cast<float>(reach_mm * reach_mm)) {
        ++open;
        never += out_of_reach[i];
      }
    }
    score.truly_unreachable_mm2 +=
        open > 0 ? t.area_mm2 * static_cast<double>(never) / static_cast<double>(open) : 0.0;
  }
  return score;
}

}  // namespace dubsar::bench
