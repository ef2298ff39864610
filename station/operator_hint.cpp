// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/operator_hint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "registration/point_pairs.h"
#include "station/hint_reach.h"

namespace dubsar {

namespace {

double distance_mm(const RangeGrid& grid, const Eigen::Vector3d& point_mm) {
  const Eigen::Vector3f p = point_mm.cast<float>();
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      least = std::min(least, (grid.point(i) - p).squaredNorm());
    }
  }
  return std::sqrt(static_cast<double>(least));
}

/// A click that is on no surface is in the wrong unit or on the wrong scan.
Status check_on_surface(const SessionStore& store, int id, const std::vector<PointPair>& pairs,
                        Eigen::Vector3d PointPair::*which, const std::string& where) {
  const Result<RangeGrid> grid = store.load_grid(id);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double away_mm = distance_mm(*grid, pairs[k].*which);
    if (!(away_mm <= kMostClickMissMm)) {
      return bad_input(where,
                       "point " + std::to_string(k + 1) + " lies " +
                           std::to_string(std::lround(std::min(away_mm, 1e9))) +
                           " mm from the nearest sample of scan " + std::to_string(id),
                       "click on the surface, in the frame of that scan, in millimetres; the scan's own "
                       "points come first");
    }
  }
  return {};
}

const ScanPose* registered(const std::vector<ScanPose>& poses, int id) {
  const auto found = std::ranges::find_if(
      poses, [&](const ScanPose& pose) { return pose.id == id && pose.status == PoseStatus::kRegistered; });
  return found == poses.end() ? nullptr : &*found;
}

Result<PoseHint> related(const SessionStore& store, int id, const RigidTransform& model_from_scanner,
                         const std::string& where) {
  const auto poses = store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  for (const ScanPose& pose : *poses) {
    if (pose.id != id && pose.status == PoseStatus::kRegistered && check_scan_stands(store, pose.id)) {
      if (const Status near =
              check_hint_reach(store, {id, model_from_scanner}, {pose.id, pose.model_from_scanner}, where);
          !near) {
        return std::unexpected(near.error());
      }
      PoseHint hint;
      hint.on = pose.id;
      hint.on_from_scanner = (pose.model_from_scanner.inverse() * model_from_scanner).orthonormalised();
      return hint;
    }
  }
  return fail(ErrorKind::kUsage, "no other scan has a place that the pose could be related to", where,
              "run register first, or name the scan that the pose is relative to with --on");
}

/// Scans that were taken one after the other show the same clay. Some of them may be taken out later.
constexpr std::size_t kMostBeside = 16;

std::map<int, RigidTransform> beside(const SessionStore& store, std::vector<ScanPose> poses,
                                     const ScanPose& locked) {
  std::ranges::stable_sort(poses, {}, [&](const ScanPose& pose) { return std::abs(pose.id - locked.id); });
  std::map<int, RigidTransform> out;
  for (const ScanPose& pose : poses) {
    if (out.size() < kMostBeside && pose.id != locked.id && pose.status == PoseStatus::kRegistered &&
        check_scan_stands(store, pose.id)) {
      out[pose.id] = (pose.model_from_scanner.inverse() * locked.model_from_scanner).orthonormalised();
    }
  }
  return out;
}

}  // namespace

Result<PoseHint> settled_hint(const SessionStore& store, int id, const GivenHint& given) {
  const std::string where = "hint for scan " + std::to_string(id);
  if (const Status stands = check_scan_stands(store, id); !stands) {
    return std::unexpected(stands.error());
  }
  const auto scans = store.scans();
  const Result<OperatorLog> log = read_operator_log(store);
  if (!scans || !log) {
    return std::unexpected(scans ? log.error() : scans.error());
  }
  if (std::ranges::count_if(*scans, [](const StoredScan& s) { return !s.dropped && !s.damaged; }) < 2) {
    return fail(ErrorKind::kUsage, "it is the only scan", where,
                "there is nothing that it could lie on; scan again first");
  }
  if (log->word.locked.contains(id)) {
    return fail(ErrorKind::kUsage, "the scan is locked", where, "unlock it first");
  }
  PoseHint hint = given.hint;
  if (given.model_from_scanner && hint.on < 0) {
    return related(store, id, *given.model_from_scanner, where);
  }
  if (hint.on < 0) {
    return fail(ErrorKind::kUsage, "it does not say which other scan it is about", where,
                "name that scan with --on");
  }
  if (hint.on == id) {
    return fail(ErrorKind::kUsage, "a scan cannot lie on itself", where, "name another scan with --on");
  }
  if (const Status stands = check_scan_stands(store, hint.on); !stands) {
    return std::unexpected(stands.error());
  }
  if (given.model_from_scanner) {
    hint.on_from_scanner = given.model_from_scanner;  // with --on, a pose is relative to that scan
  }
  if (hint.on_from_scanner) {
    const Status near = check_hint_reach(store, {id, *hint.on_from_scanner}, {hint.on, {}}, where);
    return near ? Result<PoseHint>(std::move(hint)) : std::unexpected(near.error());
  }
  if (const Status good = check_point_pairs(hint.points, where); !good) {
    return std::unexpected(good.error());
  }
  for (const auto& [scan, which] :
       {std::pair{id, &PointPair::point_mm}, std::pair{hint.on, &PointPair::on_point_mm}}) {
    if (const Status near = check_on_surface(store, scan, hint.points, which, where); !near) {
      return std::unexpected(near.error());
    }
  }
  return hint;
}

Result<ScanLock> lock_here(const SessionStore& store, int id) {
  if (const Status stands = check_scan_stands(store, id); !stands) {
    return std::unexpected(stands.error());
  }
  const auto poses = store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const ScanPose* pose = registered(*poses, id);
  if (pose == nullptr) {
    return fail(ErrorKind::kUsage,
                "scan " + std::to_string(id) + " is not registered: it has no place to keep",
                store.folder().string(), "give a hint for it and run register");
  }
  const Result<OperatorLog> log = read_operator_log(store);
  if (!log) {
    return std::unexpected(log.error());
  }
  ScanLock lock{pose->model_from_scanner};
  for (const auto& [other, locked] : log->word.locked) {
    // The stored poses are of its frame as long as they have it where it was locked.
    const ScanPose* there = registered(*poses, other);
    if (other != id && there != nullptr &&
        there->model_from_scanner.row_major() == locked.model_from_scanner.row_major()) {
      lock.frame = locked.frame;
    }
  }
  lock.beside_from_scanner = beside(store, *poses, *pose);
  return lock;
}

}  // namespace dubsar
