// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/keep_out.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/motion_limits.h"

namespace dubsar {

namespace {

/// Body around laser and camera that a device does not tell of.
constexpr double kGuessedBodyMm = 30;
/// A scanner that moves along starts and ends this far outside its field.
constexpr double kRunInMm = 3;
/// The head stays this far above the support.
constexpr double kSupportClearanceMm = 5;
/// Between two looks at the way no point of the head moves farther.
constexpr double kStepMm = 4;

std::array<Eigen::Vector3d, 8> corners_of(const HeadBox& box) {
  std::array<Eigen::Vector3d, 8> out;
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = {(k & 1U) != 0 ? box.high_mm.x() : box.low_mm.x(),
              (k & 2U) != 0 ? box.high_mm.y() : box.low_mm.y(),
              (k & 4U) != 0 ? box.high_mm.z() : box.low_mm.z()};
  }
  return out;
}

/// What is kept out of: the tablet with the margin, down to the support, all around where it is turned.
Eigen::AlignedBox3d volume_of(const Rig& rig, const StageScene& scene) {
  Eigen::AlignedBox3d box = scene.tablet_mm;
  if (box.isEmpty()) {
    return box;
  }
  if (rig.has_turntable) {
    const Eigen::Vector2d farthest = box.min().head<2>().cwiseAbs().cwiseMax(box.max().head<2>().cwiseAbs());
    const double radius = farthest.norm();
    box.extend(Eigen::Vector3d(radius, radius, box.max().z()));
    box.extend(Eigen::Vector3d(-radius, -radius, box.max().z()));
  }
  box.min().array() -= rig.keep_out_margin_mm;
  box.max().array() += rig.keep_out_margin_mm;
  box.min().z() = std::min(box.min().z(), rig.support_height_mm);
  return box;
}

/// Whether two boxes, one turned, have no point in common: 15 axes, one of which must part them (Gottschalk,
/// Lin, Manocha 1996).
bool apart(const Eigen::AlignedBox3d& still, const HeadBox& head, const RigidTransform& stage_from_head) {
  const Eigen::Vector3d half_still = 0.5 * still.sizes();
  const Eigen::Vector3d half_head = 0.5 * (head.high_mm - head.low_mm);
  const Eigen::Vector3d between = stage_from_head * head.middle_mm() - still.center();
  const auto parts = [&](const Eigen::Vector3d& axis) {
    const double reach = axis.cwiseAbs().dot(half_still) +
                         (stage_from_head.rotation.transpose() * axis).cwiseAbs().dot(half_head);
    return std::abs(axis.dot(between)) > reach + 1e-9;
  };
  for (int a = 0; a < 3; ++a) {
    if (parts(Eigen::Vector3d::Unit(a)) || parts(stage_from_head.rotation.col(a))) {
      return true;
    }
    for (int b = 0; b < 3; ++b) {
      if (parts(Eigen::Vector3d::Unit(a).cross(stage_from_head.rotation.col(b)))) {
        return true;
      }
    }
  }
  return false;
}

/// A placement of a turntable says where the scanner is on the turning stage; here the stage stands still.
RigidTransform standing_pose(const Placement& placement, const Eigen::Vector3d& focus_mm) {
  return placement.free_pose ? *placement.free_pose : stage_from_scanner(0, placement.tilt_rad, focus_mm);
}

Status check_head(const Rig& rig, const HeadBox& head, const Eigen::AlignedBox3d& volume,
                  const RigidTransform& pose, const std::string& where) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& corner : corners_of(head)) {
    lowest = std::min(lowest, (pose * corner).z());
  }
  if (!(lowest >= rig.support_height_mm + kSupportClearanceMm)) {
    return fail(ErrorKind::kUsage, "the scanner's head would touch the support", where,
                "ask for a smaller tilt or a higher place");
  }
  if (!volume.isEmpty() && !apart(volume, head, pose)) {
    return fail(ErrorKind::kUsage, "the scanner's head would come into the keep-out volume around the tablet",
                where, "ask for a place farther off");
  }
  return {};
}

/// The farthest that a point of the head is from what it is turned about.
double lever_of(const HeadBox& head) {
  double lever = 0;
  for (const Eigen::Vector3d& corner : corners_of(head)) {
    lever = std::max(lever, corner.norm());
  }
  return lever;
}

HeadBox grown(HeadBox head, double by_mm) {
  head.low_mm.array() -= by_mm;
  head.high_mm.array() += by_mm;
  return head;
}

Placement at_pose(RigidTransform pose) {
  Placement out;
  out.free_pose = std::move(pose);
  return out;
}

/// The ways that an arm tries, each as the stops before the goal.
std::vector<std::vector<Placement>> ways_of_arm(const Rig& rig, const StageScene& scene,
                                                const RigidTransform& from, const RigidTransform& to) {
  std::vector<std::vector<Placement>> ways{{}};
  const std::optional<HeadBox> head = head_of(rig);
  const Eigen::AlignedBox3d volume = volume_of(rig, scene);
  if (!head || volume.isEmpty()) {
    return ways;
  }
  // Far enough off that the head can be turned anyhow about where the tablet is.
  const double ball = 0.5 * volume.diagonal().norm() + 0.5 * (head->high_mm - head->low_mm).norm() + kStepMm;
  const auto backed_off = [&](RigidTransform pose) {
    const double there = (pose * head->middle_mm() - volume.center()).norm();
    pose.translation_mm += std::max(0.0, ball - there) * pose.rotation.col(2);
    return pose;
  };
  const RigidTransform out = backed_off(from);
  const RigidTransform in = backed_off(to);
  ways.push_back({at_pose(out), at_pose(in)});
  const auto upright = [&](RigidTransform pose) {
    pose.rotation = Eigen::Quaterniond::FromTwoVectors(pose.rotation.col(2), Eigen::Vector3d::UnitZ())
                        .toRotationMatrix() *
                    pose.rotation;
    return backed_off(pose);
  };
  ways.push_back({at_pose(out), at_pose(upright(from)), at_pose(upright(to)), at_pose(in)});
  return ways;
}

}  // namespace

std::optional<HeadBox> head_of(const Rig& rig) {
  if (rig.head || !rig.view.laser_mm || !rig.view.camera_mm) {
    return rig.head;
  }
  HeadBox head{rig.view.laser_mm->cwiseMin(*rig.view.camera_mm),
               rig.view.laser_mm->cwiseMax(*rig.view.camera_mm)};
  head = grown(head, kGuessedBodyMm);
  if (const double moves = rig.view.motion_per_row_mm.norm(); moves > 0) {
    const Eigen::Vector3d along = rig.view.motion_per_row_mm.cwiseAbs() / moves;
    head.low_mm -= (0.5 * rig.field_y_mm + kRunInMm) * along;
    head.high_mm += (0.5 * rig.field_y_mm + kRunInMm) * along;
  }
  return head;
}

StageScene unseen_tablet(const Rig& rig, const std::optional<Eigen::Vector3d>& size_mm) {
  StageScene scene;
  double radius = 0.5 * std::hypot(rig.field_x_mm, rig.field_y_mm);
  // In the lower half of the measuring volume there is room for what lies on the support.
  double height = 0.75 * rig.depth_range_mm;
  scene.focus_mm = {0, 0, rig.support_height_mm + 0.25 * rig.depth_range_mm};
  if (size_mm) {
    radius = 0.5 * size_mm->norm();
    height = size_mm->maxCoeff();
    scene.focus_mm.z() = rig.support_height_mm + 0.5 * size_mm->minCoeff();
  }
  scene.tablet_mm.extend(Eigen::Vector3d(-radius, -radius, rig.support_height_mm));
  scene.tablet_mm.extend(Eigen::Vector3d(radius, radius, rig.support_height_mm + height));
  return scene;
}

Status check_clear(const Rig& rig, const StageScene& scene, const Placement& placement,
                   const std::string& where) {
  const std::optional<HeadBox> head = head_of(rig);
  // As wide as on the way, so that what may be stood at may also be left.
  return head ? check_head(rig, grown(*head, 0.5 * kStepMm), volume_of(rig, scene),
                           standing_pose(placement, scene.focus_mm), where)
              : Status{};
}

Placement on_the_way(const Placement& from, const Placement& to, double share) {
  Placement out;
  if (from.free_pose && to.free_pose) {
    const Eigen::Quaterniond a(from.free_pose->rotation);
    const Eigen::Quaterniond b(to.free_pose->rotation);
    const Eigen::Vector3d& start = from.free_pose->translation_mm;
    out.free_pose = RigidTransform{a.slerp(share, b).normalized().toRotationMatrix(),
                                   start + share * (to.free_pose->translation_mm - start)};
    return out;
  }
  if (to.free_pose) {
    out.free_pose = to.free_pose;
    return out;
  }
  out.turntable_rad = from.turntable_rad + share * (to.turntable_rad - from.turntable_rad);
  out.tilt_rad = from.tilt_rad + share * (to.tilt_rad - from.tilt_rad);
  return out;
}

Status check_way(const Rig& rig, const StageScene& scene, const Placement& from, const Placement& to,
                 const std::string& where) {
  const std::optional<HeadBox> head = head_of(rig);
  if (!head) {
    return {};
  }
  double length = lever_of(*head) * std::abs(to.tilt_rad - from.tilt_rad);
  if (from.free_pose && to.free_pose) {
    const RigidTransform move = from.free_pose->inverse() * *to.free_pose;
    length = lever_of(*head) * move.angle_rad() + move.translation_mm.norm();
  }
  const Eigen::AlignedBox3d volume = volume_of(rig, scene);
  const int steps = std::max(1, static_cast<int>(std::ceil(length / kStepMm)));
  // Between two looks a point is at most half a step from where one of them saw it.
  const HeadBox moving = grown(*head, 0.5 * kStepMm);
  for (int k = 0; k <= steps; ++k) {
    const Placement at = on_the_way(from, to, static_cast<double>(k) / steps);
    const RigidTransform pose = standing_pose(at, scene.focus_mm);
    if (Status clear = check_head(rig, moving, volume, pose, where); !clear) {
      return clear;
    }
    if (at.free_pose && k != 0 && k != steps) {
      if (Status reached = check_reach(rig, pose, where); !reached) {
        return reached;
      }
    }
  }
  return {};
}

Result<std::vector<Placement>> safe_way(const Rig& rig, const StageScene& scene,
                                        const std::optional<Placement>& from, const Placement& to,
                                        const std::string& where) {
  Status status = check_limits(rig, to, where);
  if (status) {
    status = check_clear(rig, scene, to, where);
  }
  if (!status) {
    return std::unexpected(status.error());
  }
  const bool by_arm = from && from->free_pose && to.free_pose;
  const bool by_axes = from && !from->free_pose && !to.free_pose;
  if (!by_arm && !by_axes) {
    return std::vector<Placement>{to};
  }
  const std::vector<std::vector<Placement>> ways =
      by_arm ? ways_of_arm(rig, scene, *from->free_pose, *to.free_pose)
             : std::vector<std::vector<Placement>>{{}};
  std::optional<Error> in_the_way;
  for (std::vector<Placement> way : ways) {
    way.push_back(to);
    const Placement* at = &*from;
    Status clear;
    for (const Placement& stop : way) {
      clear = clear ? check_limits(rig, stop, where) : clear;
      clear = clear ? check_way(rig, scene, *at, stop, where) : clear;
      at = &stop;
    }
    if (clear) {
      way.front().hand_turn = to.hand_turn;
      if (way.size() > 1) {
        way.back().hand_turn.reset();
      }
      return way;
    }
    in_the_way = in_the_way ? in_the_way : clear.error();
  }
  in_the_way->what = "on the way, " + in_the_way->what;
  return std::unexpected(*in_the_way);
}

}  // namespace dubsar
