// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/intruders.h"

#include <algorithm>

namespace dubsar {

namespace {

constexpr std::size_t kPoints = 6000;
constexpr double kCellSpacings = 2.0;
/// A hand is thicker than this, and right poses and edges of the tablet are better than that.
constexpr float kInTheAirMm = 2.5F;
constexpr int kReachCells = 2;
/// Of the samples of a right scan, where the other looked, next to none stands in the air (the most
/// seen in simulated sessions was 4 %); of one with fingers in it a fifth does and more.
constexpr double kLeastShare = 0.12;
/// Of the arms of pins something always remains.
constexpr double kLeastShareWithPins = 0.25;
constexpr std::size_t kLeastPoints = 60;
/// More than this part of it the other way round, and both are in each other's way.
constexpr double kOneSided = 0.25;

}  // namespace

void IntruderFinder::add(const StationScan& scan) {
  const RangeGrid& grid = *scan.grid;
  Known known;
  known.nominal = grid.nominal;
  known.pins = grid.pin_tip_diameter_mm > 0;
  if (grid.spacing_mm > 0 && grid.valid_count() > 0) {
    known.raster = DepthRaster(grid, kCellSpacings * grid.spacing_mm);
    std::vector<std::size_t> good;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (grid.valid[i] != 0 && ((*scan.flags)[i] & (kPotentiallySparse | kNotTablet)) == 0) {
        good.push_back(i);
      }
    }
    const std::size_t used = std::min(kPoints, good.size());
    for (std::size_t k = 0; k < used; ++k) {
      known.points_mm.push_back(grid.point(good[k * good.size() / used]));
    }
  }
  scans_.insert_or_assign(scan.id, std::move(known));
}

void IntruderFinder::remove(int id) {
  scans_.erase(id);
}

IntruderFinder::InTheWay IntruderFinder::in_the_way(const Known& a, const Known& b,
                                                    const RigidTransform& b_from_a) {
  constexpr float kAnyDepthMm = -1e9F;
  const Eigen::Matrix3f rotation = b_from_a.rotation.cast<float>();
  const Eigen::Vector3f shift = b_from_a.translation_mm.cast<float>();
  InTheWay out;
  for (const Eigen::Vector3f& p : a.points_mm) {
    const Eigen::Vector3f at = rotation * p + shift;
    out.looked += b.raster.seen_through(at, kAnyDepthMm, kReachCells) ? 1 : 0;
    out.points += b.raster.seen_through(at, kInTheAirMm, kReachCells) ? 1 : 0;
  }
  return out;
}

std::optional<Intruder> IntruderFinder::look(int newest, const std::vector<ScanPose>& poses) const {
  const auto mine = scans_.find(newest);
  if (mine == scans_.end()) {
    return std::nullopt;
  }
  const auto registered = [&](int id) -> const RigidTransform* {
    const auto pose = std::ranges::find(poses, id, &ScanPose::id);
    return pose != poses.end() && pose->status == PoseStatus::kRegistered ? &pose->model_from_scanner
                                                                          : nullptr;
  };
  // One that the operator has taken out may have been of the tablet as it lay before somebody moved it.
  const auto stands = [&](int id) { return std::ranges::find(poses, id, &ScanPose::id) != poses.end(); };
  const RigidTransform* here = registered(newest);
  std::optional<Intruder> found;
  for (const auto& [id, other] : scans_) {
    const RigidTransform* there = registered(id);
    const bool lies_as_before =
        mine->second.nominal && other.nominal && mine->second.nominal->placement == other.nominal->placement;
    if (id == newest || !stands(id) || (!(here != nullptr && there != nullptr) && !lies_as_before)) {
      continue;
    }
    const RigidTransform other_from_mine =
        here != nullptr && there != nullptr
            ? there->inverse() * *here
            : other.nominal->tablet_from_scanner.inverse() * mine->second.nominal->tablet_from_scanner;
    const InTheWay mine_in_air = in_the_way(mine->second, other, other_from_mine);
    const InTheWay other_in_air = in_the_way(other, mine->second, other_from_mine.inverse());
    const double least = mine->second.pins || other.pins ? kLeastShareWithPins : kLeastShare;
    const auto offer = [&](int culprit, int witness, const InTheWay& there_is, const InTheWay& back) {
      const double share = static_cast<double>(there_is.points) /
                           static_cast<double>(std::max<std::size_t>(1, there_is.looked));
      const bool one_sided =
          static_cast<double>(back.points) < kOneSided * static_cast<double>(there_is.points);
      if (there_is.points >= kLeastPoints && share >= least && one_sided &&
          (!found || share > found->share)) {
        found = Intruder{culprit, witness, share};
      }
    };
    offer(newest, id, mine_in_air, other_in_air);
    offer(id, newest, other_in_air, mine_in_air);
  }
  return found;
}

}  // namespace dubsar
