// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/lost_places.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace dubsar::session {

namespace {

const ScanPose* pose_of(const std::vector<ScanPose>& poses, int id) {
  const auto found = std::ranges::find(poses, id, &ScanPose::id);
  return found == poses.end() ? nullptr : &*found;
}

bool same(const RigidTransform& a, const RigidTransform& b) {
  return a.rotation == b.rotation && a.translation_mm == b.translation_mm;
}

/// From the model frame of `before` to that of `now`; the identity, exactly, where a scan did not move.
std::optional<RigidTransform> frame_change(const std::vector<ScanPose>& now,
                                           const std::vector<ScanPose>& before) {
  std::optional<RigidTransform> out;
  for (const ScanPose& pose : now) {
    const ScanPose* was = pose_of(before, pose.id);
    if (pose.status != PoseStatus::kRegistered || was == nullptr || was->status != PoseStatus::kRegistered) {
      continue;
    }
    if (same(pose.model_from_scanner, was->model_from_scanner)) {
      return RigidTransform();
    }
    if (!out) {
      out = (pose.model_from_scanner * was->model_from_scanner.inverse()).orthonormalised();
    }
  }
  return out;
}

void move(ScanPose& pose, const RigidTransform& now_from_before) {
  if (same(now_from_before, RigidTransform())) {
    return;
  }
  pose.model_from_scanner = (now_from_before * pose.model_from_scanner).orthonormalised();
  if (pose.covariance) {  // about the scan's centroid, which moves along: only the axes turn
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = now_from_before.rotation;
    pose.covariance = turn * *pose.covariance * turn.transpose();
  }
}

}  // namespace

std::vector<ScanPose> with_lost_places(std::vector<ScanPose> now, const std::vector<ScanPose>& before,
                                       const std::vector<int>& lost) {
  const std::optional<RigidTransform> now_from_before = frame_change(now, before);
  std::vector<ScanPose> out = std::move(now);
  for (const int id : lost) {
    const ScanPose* was = pose_of(before, id);
    if (was == nullptr || pose_of(out, id) != nullptr) {
      continue;
    }
    ScanPose& pose = out.emplace_back(*was);
    if (pose.status == PoseStatus::kFailed) {
      continue;  // it had no place
    }
    if (now_from_before) {
      move(pose, *now_from_before);
      continue;
    }
    pose.status = PoseStatus::kFailed;
    pose.reason = "its grid is damaged, and no scan that it lay beside is registered any more";
    pose.warning.clear();
  }
  std::ranges::sort(out, {}, &ScanPose::id);
  return out;
}

}  // namespace dubsar::session
