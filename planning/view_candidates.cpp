// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/view_candidates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/sphere_directions.h"
#include "core/units.h"
#include "planning/convex_hull.h"
#include "planning/places_in_field.h"
#include "planning/tablet_on_stage.h"
#include "planning/turn_words.h"

namespace dubsar {

namespace {

constexpr std::array<Face, kFaceCount> kFaces = {Face::kObverse, Face::kReverse, Face::kLeft,
                                                 Face::kRight,   Face::kTop,     Face::kBottom};

std::string degrees(double rad) {
  return std::to_string(std::lround(deg_from_rad(rad))) + "°";
}

/// A place of the tablet that lies so near to the middle of the field, as a hand lays it, lies there.
constexpr double kLiesThereMm = 10;
/// Likewise a height, as a part of the scanner's depth.
constexpr double kSameHeightOfDepth = 0.1;

/// A scanner that tilts this far sees into what it does not see from straight above a side.
constexpr double kTiltsEnoughRad = 30 * kPi / 180;
/// Directions nearer to that of a side are as good as it.
constexpr double kOnASideCosine = 0.966;

/// The least rotation that takes one unit vector to another; half turns go about `spare`.
Eigen::Matrix3d least_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                           const Eigen::Vector3d& spare) {
  if (from.dot(to) < -0.9) {
    // Turned over about an axis across both that lies as near to `spare` as can be.
    const Eigen::Vector3d across = spare - to * to.dot(spare);
    const Eigen::Vector3d axis = across.norm() > 1e-6 ? across.normalized() : to.unitOrthogonal();
    const Eigen::Matrix3d over = Eigen::AngleAxisd(kPi, axis).toRotationMatrix();
    const Eigen::Vector3d half = over * from;
    return Eigen::Quaterniond::FromTwoVectors(half, to).toRotationMatrix() * over;
  }
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

/// The tablet on one of its sides.
struct Rest {
  Eigen::Matrix3d stage_from_model;    ///< rotation
  Eigen::Vector3d focus_mm{0, 0, 0};   ///< the point of the model that the scanner looks at
  std::optional<RigidTransform> turn;  ///< as the operator is asked for it, none for the present rest
  std::string say;
  bool off_middle = false;  ///< another place than the tablet's middle is looked at
  bool leans = false;       ///< propped, on none of its sides
};

/// Rests by hand as they are, or where the tablet reaches beyond the scanner's depth with one height of it
/// after the other in depth.
std::vector<Rest> at_heights(const Rig& rig, std::vector<Rest> rests, const ModelSurface& surface) {
  std::vector<Rest> out;
  for (const Rest& rest : rests) {
    for (const HeightInField& height : heights_in_field(rig, rest.stage_from_model, surface)) {
      Rest& there = out.emplace_back(rest);
      there.focus_mm += height.above_mm * rest.stage_from_model.row(2).transpose();
      there.turn->translation_mm.z() = -height.above_mm;
      there.say += (there.say.empty() ? "" : "; ") + height.say;
      there.off_middle = rest.off_middle || height.above_mm > 0;
    }
  }
  return out.empty() ? std::move(rests) : out;
}

/// A rest by hand as it is, or where the tablet is larger than the field with one place of it after the other
/// in the field, its middle first.
std::vector<Rest> laid(const Rig& rig, const Rest& rest, const ModelSurface& surface) {
  if (rig.robot) {  // an arm looks where it is told to
    return {rest};
  }
  std::vector<Rest> out;
  for (const PlaceInField& place : places_in_field(rig, rest.stage_from_model, surface)) {
    Rest& there = out.emplace_back(rest);
    there.focus_mm = surface.center_mm + place.offset_mm;
    there.turn->translation_mm = -(rest.stage_from_model * place.offset_mm);
    there.turn->translation_mm.z() = 0;
    there.say += (there.say.empty() ? "" : "; ") + place.say;
    there.off_middle = !place.offset_mm.isZero();
  }
  return at_heights(rig, out.empty() ? std::vector<Rest>{rest} : std::move(out), surface);
}

/// Corners and samples of the model that are lowest decide where the support is.
HiddenHalf support_under(const Eigen::Matrix3d& stage_from_model, const ModelSurface& surface) {
  HiddenHalf hidden;
  hidden.normal = stage_from_model.row(2).transpose();
  hidden.offset_mm = 0;
  bool first = true;
  for (const Eigen::Vector3d& p : surface.corners_mm) {
    const double height = hidden.normal.dot(p);
    hidden.offset_mm = first ? height : std::min(hidden.offset_mm, height);
    first = false;
  }
  // The surface rests on the support: what touches it cannot be seen at all.
  hidden.offset_mm += 0.1;
  return hidden;
}

/// Rests on none of its sides, where motors do not look aslant: steep walls are seen from there alone.
void add_leaning(const Rig& rig, const Eigen::Matrix3d& nominal_stage_from_model, const ModelSurface& surface,
                 const CandidateOptions& options, std::vector<Rest>& out) {
  if (rig.robot || rig.tilt_max_rad >= kTiltsEnoughRad) {
    return;
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d spare = nominal_stage_from_model * surface.faces.normal(Face::kTop);
  const int yaws = rig.has_turntable ? 1 : options.lean_yaw_steps;
  for (const Eigen::Vector3d& of_faces :
       sphere_directions(static_cast<std::size_t>(std::max(options.lean_directions, 1)))) {
    if (of_faces.cwiseAbs().maxCoeff() > kOnASideCosine) {
      continue;
    }
    const Eigen::Vector3d then_up = nominal_stage_from_model * surface.faces.model_from_faces * of_faces;
    const Eigen::Matrix3d tip = least_turn(then_up, up, spare);
    for (int yaw = 0; yaw < yaws; ++yaw) {
      Rest rest;
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(2 * kPi * yaw / yaws, up).toRotationMatrix() * tip;
      rest.stage_from_model = turn * nominal_stage_from_model;
      rest.focus_mm = surface.center_mm;
      rest.turn = RigidTransform{turn, Eigen::Vector3d::Zero()};
      rest.say = say_turn(turn, nominal_stage_from_model, up, surface.faces) + ", propped up";
      rest.leans = true;
      std::ranges::move(laid(rig, rest, surface), std::back_inserter(out));
    }
  }
}

std::vector<Rest> rests(const Rig& rig, const Eigen::Matrix3d& stage_from_model,
                        const Eigen::Matrix3d& nominal_stage_from_model, const Eigen::Vector3d& focus_mm,
                        const ModelSurface& surface, const CandidateOptions& options) {
  std::vector<Rest> out;
  out.push_back({stage_from_model, focus_mm, std::nullopt, {}});
  if (!rig.hand_turns) {
    return out;
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::vector<Rest> pushed =
      laid(rig, {nominal_stage_from_model, surface.center_mm, RigidTransform{}, {}}, surface);
  const bool by_height = !heights_in_field(rig, nominal_stage_from_model, surface).empty();
  for (const Rest& rest : pushed) {
    const Eigen::Vector3d way_mm = nominal_stage_from_model * (rest.focus_mm - focus_mm);
    const bool elsewhere = way_mm.head<2>().norm() > kLiesThereMm ||
                           (by_height && std::abs(way_mm.z()) > kSameHeightOfDepth * rig.depth_range_mm);
    if (pushed.size() > 1 && elsewhere) {
      out.push_back(rest);
    }
  }
  const Face lies_up = surface.faces.of(stage_from_model.transpose() * up);
  const int yaws = rig.has_turntable ? 1 : options.yaw_steps;
  for (const Face face : kFaces) {
    const Eigen::Vector3d normal = nominal_stage_from_model * surface.faces.normal(face);
    const Eigen::Vector3d spare = nominal_stage_from_model * surface.faces.normal(Face::kTop);
    const Eigen::Matrix3d tip = least_turn(normal, up, spare);
    for (int yaw = 0; yaw < yaws; ++yaw) {
      if (face == lies_up && yaw == 0) {
        continue;
      }
      Rest rest;
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(2 * kPi * yaw / yaws, up).toRotationMatrix() * tip;
      rest.stage_from_model = turn * nominal_stage_from_model;
      rest.focus_mm = surface.center_mm;
      rest.turn = RigidTransform{turn, Eigen::Vector3d::Zero()};
      rest.say = say_turn(turn, nominal_stage_from_model, up, surface.faces);
      std::ranges::move(laid(rig, rest, surface), std::back_inserter(out));
    }
  }
  add_leaning(rig, nominal_stage_from_model, surface, options, out);
  return out;
}

std::string say_drive(const Rig& rig, const Placement& placement, const Eigen::Matrix3d& stage_from_model,
                      const ModelFaces& faces) {
  if (placement.free_pose) {
    return say_arm(*placement.free_pose, stage_from_model, faces);
  }
  std::string drive;
  if (rig.has_turntable) {
    drive = "turntable to " + degrees(placement.turntable_rad);
  }
  if (rig.tilt_max_rad > rig.tilt_min_rad) {
    drive += (drive.empty() ? "tilt to " : ", tilt to ") + degrees(placement.tilt_rad);
  }
  return drive;
}

/// What an arm has to look at beside the tablet's middle, from there, stage frame.
std::vector<Eigen::Vector3d> offsets_of_arm(const Rig& rig, const Rest& rest, const ModelSurface& surface) {
  std::vector<PlaceInField> places = places_in_field(rig, rest.stage_from_model, surface);
  if (places.empty()) {
    places.emplace_back();
  }
  std::vector<HeightInField> heights = heights_in_field(rig, rest.stage_from_model, surface);
  if (heights.empty()) {
    heights.emplace_back();
  }
  std::vector<Eigen::Vector3d> out;
  for (const PlaceInField& place : places) {
    for (const HeightInField& height : heights) {
      if (!place.offset_mm.isZero() || height.above_mm > 0) {
        out.emplace_back(rest.stage_from_model * place.offset_mm +
                         height.above_mm * Eigen::Vector3d::UnitZ());
      }
    }
  }
  return out;
}

/// What the motors can do for one rest. Places off the middle are many: fewer views of each are enough.
std::vector<Placement> placements_of(const Rig& rig, const Placement& now, const Eigen::Vector3d& focus_mm,
                                     const Rest& rest, const ModelSurface& surface,
                                     const CandidateOptions& options) {
  MotorSteps fewer = options.motors;
  fewer.turntable_steps = (fewer.turntable_steps + 1) / 2;
  fewer.arm_rolls = (fewer.arm_rolls + 1) / 2;
  std::vector<Placement> out = motor_placements(rig, now, focus_mm, rest.off_middle ? fewer : options.motors);
  if (rig.robot) {
    for (const Eigen::Vector3d& offset_mm : offsets_of_arm(rig, rest, surface)) {
      std::ranges::move(motor_placements(rig, now, focus_mm + offset_mm, fewer), std::back_inserter(out));
    }
  }
  return out;
}

}  // namespace

std::vector<ViewCandidate> rig_candidates(const Rig& rig, const StageState& state, const PlacedScan& last,
                                          const ModelSurface& surface, const CandidateOptions& options) {
  const TabletOnStage lies = TabletOnStage::of(state, last);
  Eigen::Matrix3d nominal = lies.stage_from_model;
  if (last.grid->nominal) {
    // faces.model_from_faces is model_from_tablet then.
    nominal = stage_from_scanner(state.drive, Eigen::Vector3d::Zero()).rotation *
              last.grid->nominal->tablet_from_scanner.rotation.transpose() *
              surface.faces.model_from_faces.transpose();
  }
  // An arm looks where it is told to, turntable and tilt at what they turn about.
  const Eigen::Vector3d focus = rig.robot ? surface.center_mm : lies.focus_mm;
  std::vector<ViewCandidate> out;
  for (const Rest& rest : rests(rig, lies.stage_from_model, nominal, focus, surface, options)) {
    const HiddenHalf hidden = support_under(rest.stage_from_model, surface);
    TabletOnStage on_stage{rest.stage_from_model, rest.focus_mm, std::nullopt, lies.room_mm};
    if (!rest.turn) {
      on_stage.measured = lies.measured;
    }
    const StageScene scene = on_stage.scene(rig, surface.corners_mm);
    const RigidTransform model_from_stage = on_stage.pose(rig, surface.corners_mm).inverse();
    for (Placement& placement : placements_of(rig, state.drive, scene.focus_mm, rest, surface, options)) {
      if (!check_clear(rig, scene, placement, {})) {
        continue;
      }
      ViewCandidate candidate;
      if (placement.free_pose) {
        candidate.model_from_scanner = model_from_stage * *placement.free_pose;
      } else {
        candidate.model_from_scanner.rotation =
            rest.stage_from_model.transpose() *
            stage_from_scanner(placement, Eigen::Vector3d::Zero()).rotation;
        candidate.model_from_scanner.translation_mm = rest.focus_mm;
      }
      candidate.hidden = hidden;
      candidate.by_hand = rest.turn.has_value();
      candidate.leans = rest.leans;
      candidate.say = rest.say;
      if (const std::string drive = say_drive(rig, placement, rest.stage_from_model, surface.faces);
          !drive.empty()) {
        candidate.say += (candidate.say.empty() ? "" : "; then ") + drive;
      }
      if (candidate.say.empty()) {  // no motor, and nothing for hands to do
        candidate.say = "leave the tablet as it lies";
      }
      placement.hand_turn = rest.turn;
      candidate.placement = std::move(placement);
      out.push_back(std::move(candidate));
    }
  }
  return out;
}

std::vector<ViewCandidate> free_candidates(const PlacedScan& last, const ModelSurface& surface,
                                           const CandidateOptions& options) {
  std::vector<ViewCandidate> out;
  const Eigen::Matrix3d& rotation = last.model_from_scanner.rotation;
  const Eigen::Vector3d up_scanner = -last.grid->view.direction;
  const Eigen::Vector3d up_model = rotation * up_scanner;
  for (const Eigen::Vector3d& direction :
       sphere_directions(static_cast<std::size_t>(std::max(options.free_directions, 1)))) {
    // The scanner goes round the model by `move`; the tablet is turned the other way.
    const Eigen::Matrix3d move = least_turn(up_model, direction, rotation * Eigen::Vector3d::UnitY());
    const Eigen::Matrix3d turn = rotation.transpose() * move.transpose() * rotation;
    ViewCandidate candidate;
    candidate.model_from_scanner.rotation = move * rotation;
    candidate.model_from_scanner.translation_mm =
        surface.center_mm + move * (last.model_from_scanner.translation_mm - surface.center_mm);
    candidate.by_hand = true;
    candidate.say = say_turn(turn, rotation.transpose(), up_scanner, surface.faces);
    out.push_back(std::move(candidate));
  }
  return out;
}

}  // namespace dubsar
