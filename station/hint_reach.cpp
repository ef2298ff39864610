// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/hint_reach.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/number_text.h"

namespace dubsar {

namespace {

/// Empty for a scan without samples.
Result<Eigen::AlignedBox3d> box_of(const SessionStore& store, const ScanInFrame& scan) {
  const Result<RangeGrid> grid = store.load_grid(scan.id);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < grid->size(); ++i) {
    if (grid->valid[i] != 0) {
      box.extend(scan.frame_from_scanner * grid->point(i).cast<double>().eval());
    }
  }
  return box;
}

/// Along each axis; 0 where they overlap.
Eigen::Vector3d gap_mm(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return (a.min() - b.max()).cwiseMax(b.min() - a.max()).cwiseMax(0.0);
}

/// The box of all registered scans, as they lie to the one that is given.
Result<Eigen::AlignedBox3d> with_registered(const SessionStore& store, int but, const ScanInFrame& on,
                                            Eigen::AlignedBox3d box) {
  const auto poses = store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const auto base = std::ranges::find_if(*poses, [&](const ScanPose& pose) {
    return pose.id == on.id && pose.status == PoseStatus::kRegistered;
  });
  if (base == poses->end()) {
    return box;
  }
  const RigidTransform frame_from_model = on.frame_from_scanner * base->model_from_scanner.inverse();
  for (const ScanPose& pose : *poses) {
    if (pose.id == but || pose.id == on.id || pose.status != PoseStatus::kRegistered) {
      continue;
    }
    const Result<Eigen::AlignedBox3d> more =
        box_of(store, {pose.id, frame_from_model * pose.model_from_scanner});
    if (more && !more->isEmpty()) {  // one that cannot be read says nothing
      box.extend(*more);
    }
  }
  return box;
}

}  // namespace

Status check_hint_reach(const SessionStore& store, const ScanInFrame& hinted, const ScanInFrame& on,
                        const std::string& where) {
  const Result<Eigen::AlignedBox3d> box = box_of(store, hinted);
  const Result<Eigen::AlignedBox3d> on_box = box_of(store, on);
  if (!box || !on_box) {
    return std::unexpected(box ? on_box.error() : box.error());
  }
  if (box->isEmpty() || on_box->isEmpty()) {
    return {};
  }
  // The size of a box that lies so far off is lost in its digits.
  const Result<Eigen::AlignedBox3d> own = box_of(store, {hinted.id, {}});
  if (!own) {
    return std::unexpected(own.error());
  }
  const double reach_mm = std::max(own->diagonal().norm(), on_box->diagonal().norm());
  Eigen::Index axis = 0;
  if (gap_mm(*box, *on_box).maxCoeff() <= reach_mm) {
    return {};
  }
  const Result<Eigen::AlignedBox3d> all = with_registered(store, hinted.id, on, *on_box);
  if (!all) {
    return std::unexpected(all.error());
  }
  const double away_mm = gap_mm(*box, *all).maxCoeff(&axis);
  if (away_mm <= reach_mm) {
    return {};
  }
  return bad_input(where,
                   "its pose puts the scan " + short_text(away_mm, 4) + " mm away from scan " +
                       std::to_string(on.id) + " and all others, by number " +
                       std::to_string(4 * (axis + 1)) +
                       " of the 16: " + short_text(hinted.frame_from_scanner.translation_mm[axis], 4),
                   "give the shift in millimetres, good to 10 mm");
}

}  // namespace dubsar
