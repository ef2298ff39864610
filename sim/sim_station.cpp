// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/sim_station.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr double kClickErrorMm = 1.0;

Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
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
  drive_to(0, 0);
  set_scene();
}

Rig SimStation::rig() const {
  Rig rig;
  rig.name = "simulated station";
  rig.view = scanner_.rig_view();
  rig.spacing_mm = options_.scanner.spacing_mm;
  rig.field_x_mm = options_.scanner.field_x_mm;
  rig.field_y_mm = options_.scanner.field_y_mm;
  rig.depth_range_mm = options_.scanner.depth_range_mm;
  rig.has_turntable = true;
  rig.tilt_min_rad = 0;
  rig.tilt_max_rad = rad_from_deg(options_.tilt_max_deg);
  rig.hand_turns = true;
  rig.support_height_mm = 0;
  rig.calibration = "simulated, exact";
  rig.calibration_age_days = 0.0;
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
  Random random(seed_for(seed_for(options_.seed, 51), static_cast<std::uint64_t>(placement_)));
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

void SimStation::drive_to(double turntable_rad, double tilt_rad) {
  nominal_drive_ = {turntable_rad, tilt_rad, {0, 0, nominal_stage_from_tablet_.translation_mm.z()}};
  Random random(seed_for(seed_for(options_.seed, 52), static_cast<std::uint64_t>(moves_++)));
  const double sigma = rad_from_deg(options_.motor_sigma_deg);
  true_drive_ = nominal_drive_;
  true_drive_.turntable_rad += sigma * random.normal();
  true_drive_.tilt_rad += sigma * random.normal();
  for (int axis = 0; axis < 3; ++axis) {
    true_drive_.focus_mm[axis] += options_.motor_sigma_mm * random.normal();
  }
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

Status SimStation::move(const Placement& placement) {
  constexpr double kSlackRad = 1e-6;
  if (!std::isfinite(placement.turntable_rad) || !(placement.tilt_rad >= -kSlackRad) ||
      !(placement.tilt_rad <= rad_from_deg(options_.tilt_max_deg) + kSlackRad)) {
    return fail(ErrorKind::kUsage, "the simulated station cannot be driven there", "sim",
                "ask for a tilt within the rig's limits");
  }
  if (placement.hand_turn && !placement.hand_turn->is_rigid()) {
    return fail(ErrorKind::kUsage, "the turn that was asked for is no rotation", "sim",
                "give a rigid transform");
  }
  if (placement.hand_turn) {
    ++placement_;
    nominal_stage_from_tablet_ = asked_pose(nominal_stage_from_tablet_, *placement.hand_turn);
    // The operator turns what lies there, and looks at the tablet while doing so: neither this turn nor the
    // way in which the tablet then lies is off by more than a hand's error, however many turns there were.
    RigidTransform after_turn = *placement.hand_turn;
    after_turn.rotation *= true_stage_from_tablet_.rotation;
    after_turn.translation_mm += true_stage_from_tablet_.translation_mm;
    true_stage_from_tablet_ = by_hand(nominal_stage_from_tablet_, after_turn);
  }
  drive_to(placement.turntable_rad, placement.tilt_rad);
  set_scene();
  return {};
}

NominalPose SimStation::nominal() const {
  NominalPose pose;
  pose.tablet_from_scanner =
      nominal_stage_from_tablet_.inverse() *
      stage_from_scanner(nominal_drive_.turntable_rad, nominal_drive_.tilt_rad, nominal_drive_.focus_mm);
  pose.placement = placement_;
  return pose;
}

RigidTransform SimStation::nominal_after(const Placement& placement) const {
  const RigidTransform lies = placement.hand_turn
                                  ? asked_pose(nominal_stage_from_tablet_, *placement.hand_turn)
                                  : nominal_stage_from_tablet_;
  return lies.inverse() *
         stage_from_scanner(placement.turntable_rad, placement.tilt_rad, {0, 0, lies.translation_mm.z()});
}

RigidTransform SimStation::true_tablet_from_scanner() const {
  return true_stage_from_tablet_.inverse() *
         stage_from_scanner(true_drive_.turntable_rad, true_drive_.tilt_rad, true_drive_.focus_mm);
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
  grid.device = "sim";
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
    grid->device = "sim";
    grid->pin_tip_diameter_mm = pins_ ? pins_->options().tip_diameter_mm : 0.0;
  }
  return grid;
}

}  // namespace dubsar::sim
