// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that came more than once. The same samples twice are no second measurement: they would halve the
// variance of what they say and vouch for each other. So a copy is only another id of the scan that is in: a
// word that the operator gives under either is said of both. The samples tell the motion between copies in
// two frames, to within their rounding, so that these need no pose of their own.
#include <algorithm>
#include <limits>

#include "registration/scan_model.h"

namespace dubsar {

namespace {

bool is_same(const RigidTransform& a, const RigidTransform& b) {
  return a.row_major() == b.row_major();
}

}  // namespace

int ScanModel::stands_as(int id) const {
  const auto copy = copies_.find(id);
  return copy == copies_.end() ? id : copy->second.of;
}

RigidTransform ScanModel::scan_from(int id) const {
  const auto from = scan_from_.find(id);
  return from == scan_from_.end() ? RigidTransform{} : from->second;
}

PoseHint ScanModel::hint_for(int id) const {
  PoseHint hint = hints_.at(id);
  const RigidTransform from = scan_from(id);
  const RigidTransform on_from = scan_from(hint.on);
  for (PointPair& pair : hint.points) {
    pair = {from * pair.point_mm, on_from * pair.on_point_mm};
  }
  if (hint.on_from_scanner) {
    hint.on_from_scanner = on_from * *hint.on_from_scanner * from.inverse();
  }
  return hint;
}

std::optional<int> ScanModel::locked_as(int id) const {
  const auto scan = scans_.find(stands_as(id));
  if (scan == scans_.end() || !scan->second.is_locked()) {
    return std::nullopt;
  }
  const std::set<int>& ids = scan->second.locked_as;
  return ids.contains(id) ? id : *ids.begin();
}

std::vector<ScanPose> ScanModel::poses() const {
  std::vector<ScanPose> out;
  out.reserve(scans_.size() + copies_.size());
  for (const auto& [id, scan] : scans_) {
    out.push_back(pose(id));
  }
  for (const auto& [id, copy] : copies_) {
    out.push_back(pose(id));
  }
  std::ranges::sort(out, {}, &ScanPose::id);
  return out;
}

bool ScanModel::may_place(int original, int id, const RangeGrid& grid, const PinSet* pins,
                          bool has_start) const {
  const Scan& scan = scans_.at(original);
  if (!scan.usable) {
    return true;  // what is known of the scale may have changed since
  }
  const bool stands = members(scan.group).size() > 1 || pose(original).status == PoseStatus::kRegistered;
  const bool brings_more =
      has_start || (grid.nominal && !scan.nominal) || (pins != nullptr && pins->tips.contains(id));
  return !stands && scan.fault_reason.empty() && brings_more;
}

bool ScanModel::take_in(int id, const RangeGrid* grid, const PinSet* pins, bool has_start, JobContext& job) {
  std::optional<ScanPrint> print = grid != nullptr ? scan_print(*grid) : std::nullopt;
  std::optional<RigidTransform> scan_from_this;
  const auto is_same = [&](const auto& entry) {
    const std::optional<ScanPrint>& other = entry.second.print;
    scan_from_this = print && other && !is_part(*print, *other) && !is_part(*other, *print)
                         ? copy_motion(*other, *print)
                         : std::nullopt;
    return scan_from_this.has_value();
  };
  const auto before = scans_.find(stands_as(id));
  const bool is_replaced = before != scans_.end() && is_same(*before);
  remove(id, job);
  std::map<int, Copy> others;
  std::map<int, RigidTransform> others_from;
  if (const auto original = std::ranges::find_if(scans_, is_same); original != scans_.end()) {
    const auto& [of, scan] = *original;
    if (scan.is_locked() || (!is_replaced && !may_place(of, id, *grid, pins, has_start))) {
      copies_[id] = {of, grid->source};
      set_scan_from(id, *scan_from_this);
      return false;
    }
    // All ids of it are entered anew.
    others[of] = {id, scan.file};
    for (const auto& [other, copy] : copies_) {
      if (copy.of == of) {
        others[other] = {id, copy.file};
      }
    }
    for (const auto& [other, copy] : others) {
      others_from[other] = scan_from_this->inverse() * scan_from(other);
      copies_.erase(other);
      kept_poses_.erase(other);
    }
    remove(of, job);
  }
  enter(id, grid, pins);
  scans_.at(id).print = std::move(print);
  copies_.merge(others);
  for (const auto& [other, from] : others_from) {
    set_scan_from(other, from);
  }
  find_parts(id);
  return true;
}

void ScanModel::set_scan_from(int id, const RigidTransform& from) {
  if (from.row_major() == RigidTransform{}.row_major()) {
    scan_from_.erase(id);
  } else {
    scan_from_[id] = from.orthonormalised();
  }
}

RigidTransform ScanModel::group_from(int id) const {
  const RigidTransform& group_from_scanner = scans_.at(stands_as(id)).group_from_scanner;
  const auto kept = kept_poses_.find(id);
  return kept != kept_poses_.end() && is_same(kept->second.group_from_scanner, group_from_scanner)
             ? kept->second.group_from_id
             : group_from_scanner * scan_from(id);
}

RigidTransform ScanModel::scan_placed(int id, const RigidTransform& model_from_id) const {
  const auto scan = scans_.find(stands_as(id));
  const bool stays = scan != scans_.end() && scan->second.usable && scan->second.group == main_group() &&
                     is_same(group_from(id), model_from_id);
  return stays ? scan->second.group_from_scanner : model_from_id * scan_from(id).inverse();
}

void ScanModel::keep_pose(int id, const RigidTransform& model_from_id) {
  const Scan& scan = scans_.at(stands_as(id));
  const ScanSurface& surface = *scan.features.surface;
  const Eigen::Vector3d center_mm = scan_from(id).inverse() * surface.centroid_mm;
  const RigidTransform lies = scan.group_from_scanner * scan_from(id);
  const double apart_mm = (lies * center_mm - model_from_id * center_mm).norm() +
                          0.5 * surface.extent_mm * (lies.inverse() * model_from_id).angle_rad();
  // The step from one single to the next.
  const double step_mm = std::numeric_limits<float>::epsilon() * (center_mm.norm() + surface.extent_mm);
  if (apart_mm <= step_mm) {
    kept_poses_[id] = {scan.group_from_scanner, model_from_id};
  }
}

bool ScanModel::lock_at(int id, const RigidTransform& model_from_id) {
  const bool locked = lock_near(id, model_from_id) == LockOutcome::kLocked;
  if (locked) {
    keep_pose(id, model_from_id);
  }
  return locked;
}

bool ScanModel::leaves_a_copy(int id) {
  if (const auto copy = copies_.find(id); copy != copies_.end()) {
    scans_.at(copy->second.of).locked_as.erase(id);
    copies_.erase(copy);
    return true;
  }
  const auto next = std::ranges::find_if(copies_, [id](const auto& entry) { return entry.second.of == id; });
  if (next == copies_.end()) {
    return false;
  }
  hand_over(id, next->first);
  return true;
}

ScanModel::Pair ScanModel::Pair::turned() const {
  const PairConstraint other = dubsar::turned({0, 1, a_from_b, center_mm, information, true, of_a, of_b});
  return {measured_from.inverse(), other.a_from_b, other.center_mm,
          other.information,       other.of_a,     other.of_b};
}

void ScanModel::hand_over(int from, int to) {
  auto scan = scans_.extract(from);
  scan.key() = to;
  scan.mapped().file = copies_.at(to).file;
  scan.mapped().locked_as.erase(from);
  scans_.insert(std::move(scan));
  copies_.erase(to);
  for (auto& [id, copy] : copies_) {
    copy.of = copy.of == from ? to : copy.of;
  }
  for (auto& [id, other] : scans_) {
    if (other.tried_on.erase(from) > 0) {
      other.tried_on.insert(to);
    }
    for (Lead& lead : other.leads) {
      lead.on = lead.on == from ? to : lead.on;
    }
  }
  if (unchecked_.erase(from) > 0) {
    unchecked_.insert(to);
  }
  std::map<std::pair<int, int>, RigidTransform> parts;
  for (const auto& [key, whole_from_part] : parts_) {
    const auto [part, whole] = key;
    parts[{part == from ? to : part, whole == from ? to : whole}] = whole_from_part;
  }
  parts_ = std::move(parts);
  std::map<std::pair<int, int>, Pair> pairs;
  for (const auto& [key, pair] : pairs_) {
    const int a = key.first == from ? to : key.first;
    const int b = key.second == from ? to : key.second;
    pairs.emplace(std::minmax(a, b), a < b ? pair : pair.turned());
  }
  pairs_ = std::move(pairs);
}

}  // namespace dubsar
