// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/sim_station.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/motion_limits.h"
#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr double kClickErrorMm = 1.0;
/// Body of the simulated head around laser and camera.
constexpr double kBodyMm = 25;
/// The station's own keep-out: where a hand may have put the tablet, and little more.
constexpr double kMarginMm = 6;
/// Pins reach this far beyond the tablet.
constexpr double kPinRoomMm = 40;

Eigen::Vector3d random_direction(Random& random) {
  return random.normal3().normalized();
}

/// Size of an error: normal, so that small ones are usual, cut off at its greatest.
double clipped_error(Random& random, double most) {
  return std::min(most, std::abs(random.normal()) * most / 2.0);
}

}  // namespace

SimStation::SimStation(SimTablet tablet, const SimStationOptions& options)
    : options_(options),
      scanner_(options.scanner),
      tablet_(std::make_unique<SimTablet>(std::move(tablet))),
      query_(std::make_unique<MeshQuery>(tablet_->mesh)) {
  for (const Eigen::Vector3f& p : tablet_->mesh.positions) {
    half_size_mm_ = half_size_mm_.cwiseMax(p.cwiseAbs().cast<double>());
  }
  if (options.pins) {
    pins_.emplace(*tablet_, *query_, *options.pins);
  }
  nominal_stage_from_tablet_ = asked_pose({}, {});
  true_stage_from_tablet_ = by_hand(nominal_stage_from_tablet_, nominal_stage_from_tablet_);
  Placement start;
  if (options_.robot) {
    start.free_pose =
        Drive{0, 0, {0, 0, nominal_stage_from_tablet_.translation_mm.z()}, {}}.stage_from_scanner();
  }
  drive_to(start);
  set_scene();
}

RigidTransform SimStation::Drive::stage_from_scanner() const {
  return arm ? *arm : dubsar::stage_from_scanner(turntable_rad, tilt_rad, focus_mm);
}

Rig SimStation::rig() const {
  Rig rig;
  rig.name = "simulated station";
  rig.view = scanner_.rig_view();
  rig.spacing_mm = options_.scanner.spacing_mm;
  rig.field_x_mm = options_.scanner.field_x_mm;
  rig.field_y_mm = options_.scanner.field_y_mm;
  rig.depth_range_mm = options_.scanner.depth_range_mm;
  rig.has_turntable = !options_.robot;
  rig.tilt_min_rad = 0;
  rig.tilt_max_rad = rad_from_deg(options_.tilt_max_deg);
  rig.hand_turns = true;
  rig.support_height_mm = 0;
  rig.calibration = "simulated, exact";
  rig.calibration_age_days = 0.0;
  rig.keep_out_margin_mm = kMarginMm;
  const ScannerOptions& scanner = options_.scanner;
  const double along = 0.5 * scanner.field_y_mm + scanner.margin_mm + kBodyMm;
  rig.head = HeadBox{{-kBodyMm, -along, scanner.standoff_mm - kBodyMm},
                     {kBodyMm, along + scanner.baseline_mm, scanner.standoff_mm + kBodyMm}};
  if (options_.robot) {
    // An arm beside the stage that takes the head all around the upper half at its working distance.
    const double unit = scanner.standoff_mm;
    rig.robot =
        RobotReach{{0, -2.4 * unit, 0}, {0.6 * unit, 4.0 * unit}, {0, 2.4 * unit}, {0.6 * unit, 2 * unit}};
  }
  return rig;
}

double SimStation::resting_height_mm(const Eigen::Matrix3d& stage_from_tablet) const {
  // A rounded body touches the support nearer than the corner of its box would: half way between box and
  // ellipsoid is what an operator's ruler gives.
  const Eigen::Vector3d reach = stage_from_tablet.row(2).transpose().cwiseProduct(half_size_mm_);
  return 0.5 * (reach.cwiseAbs().sum() + reach.norm());
}

RigidTransform SimStation::asked_pose(const RigidTransform& from, const RigidTransform& turn) const {
  RigidTransform pose;
  pose.rotation = RigidTransform{turn.rotation * from.rotation, {0, 0, 0}}.orthonormalised().rotation;
  pose.translation_mm = {turn.translation_mm.x(), turn.translation_mm.y(), resting_height_mm(pose.rotation)};
  return pose;
}

double SimStation::touching_height_mm(const Eigen::Matrix3d& stage_from_tablet) const {
  const Eigen::Vector3f down = stage_from_tablet.row(2).transpose().cast<float>();
  float lowest = 0;
  for (const Eigen::Vector3f& p : tablet_->mesh.positions) {
    lowest = std::min(lowest, down.dot(p));
  }
  return -static_cast<double>(lowest);
}

RigidTransform SimStation::by_hand(const RigidTransform& asked, const RigidTransform& after_turn) const {
  Random random(seed_for(seed_for(options_.seed, 51 + 1000 * static_cast<std::uint64_t>(swaps_)),
                         static_cast<std::uint64_t>(placement_)));
  const double most_rad = rad_from_deg(options_.hand_max_deg);
  const double most_mm = options_.hand_max_mm;
  const double lift = random.uniform(0.0, 0.05);
  double scale = 1.0;
  RigidTransform pose;
  for (int attempt = 0; attempt < 200; ++attempt) {
    // Each failed attempt is less clumsy; the last ones are as good as what was asked for.
    scale *= 0.97;
    const Eigen::Vector3d axis = random_direction(random);
    const double angle = scale * clipped_error(random, most_rad);
    const double bearing = random.uniform(0.0, 2.0 * kPi);
    const double slip = scale * clipped_error(random, most_mm);
    pose.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * asked.rotation;
    if (RigidTransform{pose.rotation * after_turn.rotation.transpose(), {0, 0, 0}}.angle_rad() > most_rad) {
      continue;
    }
    pose.translation_mm =
        asked.translation_mm + slip * Eigen::Vector3d(std::cos(bearing), std::sin(bearing), 0);
    pose.translation_mm.z() = lift + touching_height_mm(pose.rotation);
    if ((pose.translation_mm - asked.translation_mm).norm() <= most_mm &&
        (pose.translation_mm - after_turn.translation_mm).head<2>().norm() <= most_mm) {
      break;
    }
  }
  return pose;
}

double SimStation::focus_height_mm(const RigidTransform& stage_from_tablet,
                                   const Placement& placement) const {
  return stage_from_tablet.translation_mm.z() +
         (placement.hand_turn ? -placement.hand_turn->translation_mm.z() : focus_above_middle_mm_);
}

void SimStation::drive_to(const Placement& placement) {
  nominal_drive_ = {placement.turntable_rad,
                    placement.tilt_rad,
                    {0, 0, focus_height_mm(nominal_stage_from_tablet_, placement)},
                    placement.free_pose};
  Random random(seed_for(seed_for(options_.seed, 52), static_cast<std::uint64_t>(moves_++)));
  const double sigma = rad_from_deg(options_.motor_sigma_deg);
  true_drive_ = nominal_drive_;
  true_drive_.turntable_rad += sigma * random.normal();
  true_drive_.tilt_rad += sigma * random.normal();
  for (int axis = 0; axis < 3; ++axis) {
    true_drive_.focus_mm[axis] += options_.motor_sigma_mm * random.normal();
  }
  if (true_drive_.arm) {
    const Eigen::Vector3d turn = random.normal3();
    const Eigen::Vector3d shift = true_drive_.focus_mm - nominal_drive_.focus_mm;
    true_drive_.arm->rotation =
        true_drive_.arm->rotation * RigidTransform::from_twist(sigma * turn, {0, 0, 0}).rotation;
    true_drive_.arm->translation_mm += shift;
  }
}

Placement SimStation::present() const {
  Placement out;
  out.turntable_rad = nominal_drive_.turntable_rad;
  out.tilt_rad = nominal_drive_.tilt_rad;
  out.free_pose = nominal_drive_.arm;
  return out;
}

StageScene SimStation::nominal_scene(const RigidTransform& stage_from_tablet,
                                     const Placement& placement) const {
  StageScene scene;
  scene.focus_mm = {0, 0, focus_height_mm(stage_from_tablet, placement)};
  Eigen::Vector3d reach = stage_from_tablet.rotation.cwiseAbs() * half_size_mm_;
  reach.array() += pins_ ? kPinRoomMm : 0.0;
  scene.tablet_mm.extend(stage_from_tablet.translation_mm - reach);
  scene.tablet_mm.extend(stage_from_tablet.translation_mm + reach);
  return scene;
}

void SimStation::set_scene() {
  scene_ = Scene{};
  scene_.tablet = tablet_.get();
  scene_.query = query_.get();
  const RigidTransform tablet_from_stage = true_stage_from_tablet_.inverse();
  Support support;
  support.normal = tablet_from_stage.rotation.col(2);
  support.offset_mm = support.normal.dot(tablet_from_stage.translation_mm);
  scene_.support = support;
  if (pins_) {
    scene_.pins = standing_pins(pins_->placed(placement_), scene_, scanner_, true_tablet_from_scanner());
  }
}

Status SimStation::check(const Placement& placement) const {
  const Rig mine = rig();
  if (const Status allowed = check_limits(mine, placement, "sim"); !allowed) {
    return allowed;
  }
  const RigidTransform lies = placement.hand_turn
                                  ? asked_pose(nominal_stage_from_tablet_, *placement.hand_turn)
                                  : nominal_stage_from_tablet_;
  Placement goal = placement;
  if (options_.robot && !goal.free_pose) {
    goal.free_pose = nominal_drive_.arm;
  }
  return check_way(mine, nominal_scene(lies, placement), present(), goal, "sim");
}

Status SimStation::move(const Placement& placement, double share) {
  if (const Status allowed = check(placement); !allowed) {
    return allowed;
  }
  const Placement from = present();
  Placement goal = placement;
  if (options_.robot && !goal.free_pose) {
    goal.free_pose = from.free_pose;
  }
  if (placement.hand_turn) {
    ++placement_;
    const Eigen::Vector3d off_mm =
        true_stage_from_tablet_.translation_mm - nominal_stage_from_tablet_.translation_mm;
    nominal_stage_from_tablet_ = asked_pose(nominal_stage_from_tablet_, *placement.hand_turn);
    // The operator turns what lies there, and looks at the tablet while doing so: neither this turn nor the
    // way in which the tablet then lies is off by more than a hand's error, however many turns there were.
    RigidTransform after_turn = *placement.hand_turn;
    after_turn.rotation *= true_stage_from_tablet_.rotation;
    after_turn.translation_mm += off_mm;
    true_stage_from_tablet_ = by_hand(nominal_stage_from_tablet_, after_turn);
    focus_above_middle_mm_ = -placement.hand_turn->translation_mm.z();
  }
  drive_to(share < 1.0 ? on_the_way(from, goal, share) : goal);
  set_scene();
  return {};
}

NominalPose SimStation::nominal() const {
  NominalPose pose;
  pose.tablet_from_scanner = nominal_stage_from_tablet_.inverse() * nominal_drive_.stage_from_scanner();
  pose.placement = placement_;
  return pose;
}

RigidTransform SimStation::nominal_after(const Placement& placement) const {
  const RigidTransform lies = placement.hand_turn
                                  ? asked_pose(nominal_stage_from_tablet_, *placement.hand_turn)
                                  : nominal_stage_from_tablet_;
  return lies.inverse() *
         dubsar::stage_from_scanner(placement, Eigen::Vector3d(0, 0, focus_height_mm(lies, placement)));
}

RigidTransform SimStation::true_tablet_from_scanner() const {
  return true_stage_from_tablet_.inverse() * true_drive_.stage_from_scanner();
}

void SimStation::swap(SimTablet tablet) {
  *tablet_ = std::move(tablet);
  query_ = std::make_unique<MeshQuery>(tablet_->mesh);
  if (pins_) {
    pins_.emplace(*tablet_, *query_, *options_.pins);
  }
  ++swaps_;
  true_stage_from_tablet_ = by_hand(nominal_stage_from_tablet_, nominal_stage_from_tablet_);
  set_scene();
}

void SimStation::disturb(Disturbance what, int turn) {
  set_scene();
  if (what == Disturbance::kNone) {
    return;
  }
  disturbed_ = std::make_unique<SimTablet>(disturbed(*tablet_, true_tablet_from_scanner(), what, turn));
  disturbed_query_ = std::make_unique<MeshQuery>(disturbed_->mesh);
  // The field stays where the tablet was.
  scene_.tablet = what == Disturbance::kGone ? tablet_.get() : disturbed_.get();
  scene_.query = disturbed_query_.get();
}

std::vector<PinTip> SimStation::true_tips() const {
  return tips_in_scanner(scene_.pins, true_tablet_from_scanner());
}

std::vector<PinTip> SimStation::clicked_tips() const {
  return sim::clicked_tips(true_tips(), kClickErrorMm,
                           seed_for(options_.seed, static_cast<std::uint64_t>(1000 + moves_)));
}

RangeGrid SimStation::empty_grid() const {
  RangeGrid grid = grid_of(scanner_.layout(scene_, true_tablet_from_scanner()));
  grid.nominal = nominal();
  if (pins_) {
    grid.pin_tip_diameter_mm = pins_->options().tip_diameter_mm;
  }
  return grid;
}

Status SimStation::scan(const RowSink& sink, JobContext& job) {
  return scanner_.scan(scene_, true_tablet_from_scanner(), static_cast<std::uint64_t>(scans_made_++), sink,
                       job);
}

Result<RangeGrid> SimStation::scan_grid(JobContext& job) {
  Result<RangeGrid> grid =
      scanner_.scan_grid(scene_, true_tablet_from_scanner(), static_cast<std::uint64_t>(scans_made_++), job);
  if (grid) {
    grid->nominal = nominal();
    grid->pin_tip_diameter_mm = pins_ ? pins_->options().tip_diameter_mm : 0.0;
  }
  return grid;
}

}  // namespace dubsar::sim
