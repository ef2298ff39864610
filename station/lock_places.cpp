// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/lock_places.h"

#include <algorithm>
#include <utility>

namespace dubsar {

namespace {

/// About half a tablet: what a turn moves.
constexpr double kArmMm = 50.0;

constexpr const char* kOtherFrame =
    "; its lock is of another frame, and nothing says where that lies; unlock it, and lock it again";

double apart_mm(const RigidTransform& a, const RigidTransform& b) {
  return (a.translation_mm - b.translation_mm).norm() + kArmMm * (a.inverse() * b).angle_rad();
}

/// Of what the scans beside it say, the one that most of the others agree with: one of them may have been
/// moved since. Nothing when none of them is registered.
std::optional<RigidTransform> place_of(const ScanLock& lock, const std::vector<ScanPose>& poses) {
  std::vector<RigidTransform> said;
  for (const ScanPose& pose : poses) {
    const auto beside = lock.beside_from_scanner.find(pose.id);
    if (beside != lock.beside_from_scanner.end() && pose.status == PoseStatus::kRegistered) {
      said.push_back((pose.model_from_scanner * beside->second).orthonormalised());
    }
  }
  std::optional<std::pair<double, std::size_t>> best;
  for (std::size_t k = 0; k < said.size(); ++k) {
    std::vector<double> away;
    for (const RigidTransform& other : said) {
      away.push_back(apart_mm(said[k], other));
    }
    const auto middle = away.begin() + static_cast<std::ptrdiff_t>(away.size() / 2);
    std::ranges::nth_element(away, middle);
    best = best ? std::min(*best, std::pair{*middle, k}) : std::pair{*middle, k};
  }
  return best ? std::optional(said[best->second]) : std::nullopt;
}

std::string contradiction(const std::vector<ScanPose>& poses, const std::map<int, ScanLock>& locked) {
  const auto other = std::ranges::find_if(
      poses, [&](const ScanPose& pose) { return pose.locked && locked.contains(pose.id); });
  return other == poses.end()
             ? "its lock contradicts where the other scans lie; unlock it, and register again"
             : "its lock and that of scan " + std::to_string(other->id) +
                   " contradict each other; unlock one of the two, and register again";
}

}  // namespace

std::optional<std::int64_t> frame_of_locks(const std::map<int, ScanLock>& locked,
                                           const std::function<bool(int)>& is_there) {
  std::optional<std::pair<bool, std::int64_t>> best;
  for (const auto& [id, lock] : locked) {
    if (is_there(id)) {
      best = std::max(best, std::optional(std::pair{lock.stood, lock.frame}));
    }
  }
  return best ? std::optional(best->second) : std::nullopt;
}

SettledLocks settle_locks(Registrar& registrar, const std::map<int, ScanLock>& locked, JobContext& job) {
  SettledLocks out;
  const std::vector<ScanPose> poses = registrar.poses();
  for (const ScanPose& pose : poses) {
    const auto entry = locked.find(pose.id);
    if (entry == locked.end() || pose.locked) {
      continue;
    }
    const ScanLock& lock = entry->second;
    const std::optional<RigidTransform> place = place_of(lock, poses);
    switch (registrar.lock_near(pose.id, place.value_or(lock.model_from_scanner))) {
      case LockOutcome::kLocked:
        break;
      case LockOutcome::kElsewhere:
        out.contradicted[pose.id] = contradiction(poses, locked);
        break;
      case LockOutcome::kNotRegistered:
        // The operator speaks for it, as far as it is known what they said.
        if (!place) {
          out.contradicted[pose.id] = pose.reason + kOtherFrame;
        } else if (registrar.set_pose(pose.id, *place, true, job)) {
          out.placed = true;
        }
    }
  }
  return out;
}

void tell_contradicted(std::vector<ScanPose>& poses, const std::map<int, std::string>& contradicted) {
  for (ScanPose& pose : poses) {
    if (const auto told = contradicted.find(pose.id); told != contradicted.end()) {
      pose.status = pose.status == PoseStatus::kFailed ? PoseStatus::kFailed : PoseStatus::kUnsure;
      pose.reason = told->second;
      pose.locked = true;  // as its lock still stands, and may be taken away
    }
  }
}

}  // namespace dubsar
