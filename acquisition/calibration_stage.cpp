// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_stage.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <utility>

namespace dubsar {

namespace {

struct Seen {
  double position = 0;
  RigidTransform camera_from_board;
};

std::map<std::string, std::vector<Seen>> boards_on_stage(const std::vector<CalibrationView>& views,
                                                         const Intrinsics& intrinsics) {
  std::map<std::string, std::vector<Seen>> out;
  for (std::size_t k = 0; k < intrinsics.used.size(); ++k) {
    const CalibrationView& view = views[intrinsics.used[k]];
    if (!view.fixed.empty()) {
      out[view.fixed].push_back({view.stage_position, intrinsics.camera_from_board[k]});
    }
  }
  return out;
}

/// A mirror that comes back comes back to within this of where it was; and a position that was written in
/// degrees is read a rounding beside itself. What a plane moves by on so little of the way is micrometres.
constexpr double kSamePlaceRad = 1e-4;

constexpr const char* kMend =
    "lay the board on the stage, take a picture, move the stage, and so on: five positions over its whole "
    "way";

/// Where a camera that looks at p would say the object went: least squares over all boards.
Result<RigMotion> direction_of(const std::map<std::string, std::vector<Seen>>& boards) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double spread = 0;
  for (const auto& [name, seen] : boards) {
    double mean = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Seen& one : seen) {
      mean += one.position / static_cast<double>(seen.size());
      middle += one.camera_from_board.translation_mm / static_cast<double>(seen.size());
    }
    for (const Seen& one : seen) {
      moment += (one.position - mean) * (one.camera_from_board.translation_mm - middle);
      spread += (one.position - mean) * (one.position - mean);
    }
  }
  if (!(spread > 1e-9)) {
    return bad_input({}, "all pictures of the board on the stage were taken at one position", kMend);
  }
  RigMotion motion;
  motion.kind = MotionKind::kLinear;
  motion.direction = -moment / spread;  // the head goes the other way than the board
  if (!(motion.direction.norm() > 1e-3)) {
    return bad_input({}, "the board did not move when the stage did", "see that the board lies on the stage");
  }
  return motion;
}

/// Rotations about one axis: its direction from the rotations between positions, a point from where the
/// circles have their centres.
Result<RigMotion> axis_of(const std::map<std::string, std::vector<Seen>>& boards) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [name, seen] : boards) {
    for (std::size_t i = 1; i < seen.size(); ++i) {
      const double turned = seen[i].position - seen[0].position;
      const Eigen::AngleAxisd between(seen[i].camera_from_board.rotation *
                                      seen[0].camera_from_board.rotation.transpose());
      // The rotation vector, taken the same way round as the stage says.
      const double wrapped = std::remainder(turned, 2 * M_PI);
      if (std::abs(wrapped) > 0.02 && std::abs(wrapped) < 3.0) {
        sum += between.angle() * between.axis() * (wrapped > 0 ? 1.0 : -1.0);
      }
    }
  }
  if (!(sum.norm() > 0.02)) {
    return bad_input({}, "the board did not turn when the stage did", kMend);
  }
  RigMotion motion;
  motion.kind = MotionKind::kTurntable;
  motion.direction = sum.normalized();
  // c with t_i - R t_0 = (1 - R) c for all pairs; along the axis c is free: the least norm is taken.
  Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& [name, seen] : boards) {
    for (std::size_t i = 1; i < seen.size(); ++i) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(seen[i].position - seen[0].position, motion.direction).toRotationMatrix();
      const Eigen::Matrix3d a = Eigen::Matrix3d::Identity() - turn;
      normal += a.transpose() * a;
      right += a.transpose() *
               (seen[i].camera_from_board.translation_mm - turn * seen[0].camera_from_board.translation_mm);
    }
  }
  motion.axis_point_mm = normal.ldlt().solve(right);
  return motion;
}

}  // namespace

Result<RigMotion> stage_from_poses(MotionKind kind, const std::vector<CalibrationView>& views,
                                   const Intrinsics& intrinsics) {
  const std::map<std::string, std::vector<Seen>> boards = boards_on_stage(views, intrinsics);
  std::size_t most = 0;
  for (const auto& [name, seen] : boards) {
    most = std::max(most, seen.size());
  }
  if (most < 3) {
    return bad_input(
        {}, "the board was seen on the stage at " + std::to_string(most) + " positions, 3 are the least",
        kMend);
  }
  return kind == MotionKind::kLinear ? direction_of(boards) : axis_of(boards);
}

Result<MirrorFit> mirror_from_stripes(const std::vector<CalibrationView>& views, const Intrinsics& intrinsics,
                                      const std::vector<StripeSample>& stripes) {
  std::map<double, std::vector<Eigen::Vector3d>> at;
  for (const StripeSample& sample : stripes) {
    at[views[intrinsics.used[sample.view]].mirror_position].push_back(sample.point_mm);
  }
  std::vector<std::pair<double, std::vector<Eigen::Vector3d>>> stands;
  for (auto& [position, points] : at) {
    if (stands.empty() || position - stands.back().first > kSamePlaceRad) {
      stands.emplace_back(position, std::move(points));
    } else {
      stands.back().second.insert(stands.back().second.end(), points.begin(), points.end());
    }
  }
  std::vector<std::pair<double, Plane>> planes;
  for (const auto& [position, points] : stands) {
    Result<PlaneFit> fit = fit_plane(points);
    if (fit) {
      Plane plane = fit->plane;
      if (!planes.empty() && plane.normal.dot(planes.back().second.normal) < 0) {
        plane = {-plane.normal, -plane.distance_mm};
      }
      planes.emplace_back(position, plane);
    }
  }
  if (planes.size() < 3) {
    return bad_input(
        {},
        "the laser plane is known at " + std::to_string(planes.size()) + " mirror positions, 3 are the least",
        "show the stripe on two or more board poses at each of three mirror positions");
  }
  // The axis lies in all of the planes: its direction is across their normals.
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  Eigen::Vector3d swing = Eigen::Vector3d::Zero();
  for (const auto& [position, plane] : planes) {
    scatter += plane.normal * plane.normal.transpose();
    normal += plane.normal * plane.normal.transpose();
    right += plane.normal * plane.distance_mm;
    swing += (position - planes.front().first) * planes.front().second.normal.cross(plane.normal);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  MirrorFit out;
  out.motion.kind = MotionKind::kGalvanometer;
  out.motion.direction = solver.eigenvectors().col(0);
  if (out.motion.direction.dot(swing) < 0) {
    out.motion.direction = -out.motion.direction;
  }
  normal += 1e-9 * Eigen::Matrix3d::Identity();
  out.motion.axis_point_mm = normal.ldlt().solve(right);
  // At position 0: the plane nearest to it, turned back.
  const auto nearest = std::min_element(planes.begin(), planes.end(), [](const auto& a, const auto& b) {
    return std::abs(a.first) < std::abs(b.first);
  });
  out.laser = out.motion.laser_at(nearest->second, -nearest->first);
  return out;
}

}  // namespace dubsar
