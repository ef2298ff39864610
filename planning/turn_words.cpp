// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/turn_words.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::array<Face, kFaceCount> kFaces = {Face::kObverse, Face::kReverse, Face::kLeft,
                                                 Face::kRight,   Face::kTop,     Face::kBottom};

/// Smaller tips and turns than these are no work for hands.
constexpr double kTipMinRad = 5 * std::numbers::pi / 180;
constexpr double kTurnMinRad = 8 * std::numbers::pi / 180;
/// Half of the corner between two neighbouring ways.
constexpr double kHalfCornerRad = std::numbers::pi / 8;
/// Tipped farther than this, the face behind a side is nearer to the camera than the side itself.
constexpr double kMoreThanASideRad = 135 * std::numbers::pi / 180;
/// Turned over this far, a tablet may go any way round: what differs is how it lies afterwards.
constexpr double kTurnedOverRad = 170 * std::numbers::pi / 180;
/// A face whose normal is this much along the line of sight has no side to which it looks.
constexpr double kAlongSight = 0.8;

std::string degrees(double rad) {
  return std::to_string(std::lround(deg_from_rad(rad))) + "°";
}

/// The part of a rotation that goes about `up`, counter-clockwise seen against it, -pi to pi: what is left
/// when a tip about an axis across `up` came first.
double twist_rad(const Eigen::Matrix3d& turn, const Eigen::Vector3d& up) {
  const Eigen::Quaterniond q(turn);
  return std::remainder(2 * std::atan2(q.vec().dot(up), q.w()), 2 * kPi);
}

/// A tip that lifts what looks `way`, a unit vector across `up`, towards it.
Eigen::Matrix3d tip_of(const Eigen::Vector3d& way, const Eigen::Vector3d& up, double rad) {
  return Eigen::AngleAxisd(rad, way.cross(up)).toRotationMatrix();
}

/// A face that looks to a side before the turn.
struct LyingFace {
  Face face = Face::kObverse;
  double upright = 0;            ///< its normal along `up`, -1 to 1
  Eigen::Vector3d way{0, 0, 0};  ///< unit, across `up`: the side to which it looks
};

class LyingFaces {
 public:
  LyingFaces(const Eigen::Matrix3d& frame_from_model, const Eigen::Vector3d& up, const ModelFaces& faces) {
    for (const Face face : kFaces) {
      const Eigen::Vector3d normal = frame_from_model * faces.normal(face);
      const double upright = normal.dot(up);
      if (upright < -kAlongSight) {
        away_ = face;
      } else if (upright <= kAlongSight) {
        sides_.push_back({face, upright, (normal - up * upright).normalized()});
      }
    }
  }

  /// The face that looks away from the camera, if one does.
  [[nodiscard]] std::optional<Face> away() const { return away_; }
  /// Those that look to a side.
  [[nodiscard]] std::span<const LyingFace> sides() const { return sides_; }

  /// What a tip lifts: a face, or the corner between two.
  [[nodiscard]] std::pair<Face, std::optional<Face>> lifted(const Eigen::Vector3d& way,
                                                            double tip_rad) const {
    std::vector<LyingFace> nearest = sides_;
    std::ranges::stable_sort(nearest, {}, [&](const LyingFace& side) {
      // Two may look the same way, one up and one down: the one that comes nearer to the camera.
      const double along = side.way.dot(way);
      const double across = std::sqrt(1 - side.upright * side.upright);
      const double after = side.upright * std::cos(tip_rad) + across * along * std::sin(tip_rad);
      return std::pair(-std::round(along * 1e6), -after);
    });
    const LyingFace& first = nearest.front();
    if (first.way.dot(way) < std::cos(kHalfCornerRad)) {
      for (const LyingFace& side : nearest) {
        if (side.way.dot(first.way) < std::cos(kHalfCornerRad)) {
          return {std::min(first.face, side.face), std::max(first.face, side.face)};
        }
      }
    }
    return {first.face, std::nullopt};
  }

 private:
  std::optional<Face> away_;
  std::vector<LyingFace> sides_;
};

std::string about_sight(double rad) {
  return degrees(std::abs(rad)) +
         (rad > 0 ? " counter-clockwise seen from the camera" : " clockwise seen from the camera");
}

}  // namespace

std::string say_turn(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& frame_from_model,
                     const Eigen::Vector3d& up, const ModelFaces& faces) {
  const double tip_rad = std::acos(std::clamp(up.dot(turn * up), -1.0, 1.0));
  double about_rad = twist_rad(turn, up);
  if (tip_rad < kTipMinRad) {
    return std::abs(about_rad) < rad_from_deg(2.0)
               ? "leave the tablet as it lies"
               : "turn the tablet where it lies, " + about_sight(about_rad);
  }
  const LyingFaces lying(frame_from_model, up, faces);
  // What comes to the camera before the turn about it.
  const Eigen::Vector3d comes = turn.transpose() * up;
  Eigen::Vector3d way = (comes - up * comes.dot(up)).normalized();
  if (tip_rad > kTurnedOverRad) {
    about_rad = 2 * kPi;
    for (const LyingFace& side : lying.sides()) {
      const double rad = twist_rad(turn * tip_of(side.way, up, kPi).transpose(), up);
      if (std::abs(rad) < std::abs(about_rad) - 1e-6) {
        about_rad = rad;
        way = side.way;
      }
    }
  }
  const auto [first, second] = lying.lifted(way, tip_rad);
  const std::string what =
      second ? std::string("the corner between ") + spoken(first) + " and " + spoken(*second) : spoken(first);
  std::string say;
  if (tip_rad > kMoreThanASideRad && lying.away()) {
    say = std::string("turn ") + spoken(*lying.away()) + " towards the camera, " + degrees(tip_rad) +
          ", by way of " + what;
  } else {
    say = (second ? "turn it so that " + what + " comes towards the camera, "
                  : "turn " + what + " towards the camera, ") +
          degrees(tip_rad);
  }
  if (std::abs(about_rad) > kTurnMinRad) {
    say += ", and turn it where it lies, " + about_sight(about_rad);
  }
  return say;
}

}  // namespace dubsar
