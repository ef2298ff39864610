// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How the tablet lies, by what motors and hands have done, and the views that follow from that alone.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "planning/next_view.h"
#include "planning/side_view.h"
#include "station/planning_stage.h"

namespace dubsar {

std::optional<StageState> PlanningStage::stage() const {
  std::optional<StageState> out;
  for (const PlacedScan& scan : cleared_.scans()) {
    if (const auto& drive = scans_.at(scan.id).drive) {
      out = StageState{scan.id, *drive};  // the last registered one tells how the tablet lies now
    }
  }
  return out;
}

std::optional<StageScene> PlanningStage::scene_for(const Rig& rig, const Placement& placement) const {
  const std::optional<StageState> state = stage();
  if (!state) {
    return std::nullopt;
  }
  const std::vector<PlacedScan> scans = cleared_.scans();
  const auto last = std::ranges::find(scans, state->scan_id, &PlacedScan::id);
  const std::vector<Eigen::Vector3d> points = reach_points(scans);
  const TabletOnStage lies = TabletOnStage::of(*state, *last);
  if (!placement.hand_turn || points.empty()) {
    return lies.scene(rig, points);
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) {
    box.extend(p);
  }
  return lies.turned(*placement.hand_turn, box.center()).scene(rig, points);
}

bool PlanningStage::knows_how_it_lies() const {
  const std::optional<StageState> state = stage();
  const StationScan* last = nullptr;
  for (const auto& [id, scan] : scans_) {
    last = scan.drive ? &scan : last;
  }
  if (!state || last == nullptr || last->id == state->scan_id) {
    return state.has_value();
  }
  const std::optional<NominalPose>& then = scans_.at(state->scan_id).grid->nominal;
  const std::optional<NominalPose>& now = last->grid->nominal;
  return then && now && then->placement == now->placement;
}

std::optional<int> PlanningStage::turns_go_from() const {
  const std::vector<PlacedScan> scans = cleared_.scans();
  const std::optional<StageState> state = stage();
  if (scans.empty() || (state && knows_how_it_lies())) {
    return std::nullopt;
  }
  const int from = state ? state->scan_id : scans.back().id;
  const int newest = scans_.rbegin()->first;
  const bool has_place = std::ranges::any_of(poses_, [newest](const ScanPose& pose) {
    return pose.id == newest && pose.status == PoseStatus::kRegistered;
  });
  return newest > from && !has_place ? std::optional(from) : std::nullopt;
}

std::optional<NextView> PlanningStage::before_lifting(const Rig& rig, const NextView& next) const {
  const double from_the_side = rad_from_deg(40.0);
  const std::optional<StageState> state = stage();
  if (!state || !next.placement || !next.placement->hand_turn) {
    return std::nullopt;
  }
  const std::vector<PlacedScan> scans = cleared_.scans();
  if (scans.size() != 1) {
    return std::nullopt;
  }
  return side_view(rig, *state, scans.front(), model_surface(scans), from_the_side);
}

std::optional<PlacedScan> PlanningStage::where_driven(int id) const {
  const std::vector<PlacedScan> scans = cleared_.scans();
  const auto found = scans_.find(id);
  if (found == scans_.end() || !found->second.drive || scans.empty()) {
    return std::nullopt;
  }
  if (const auto placed = std::ranges::find(scans, id, &PlacedScan::id); placed != scans.end()) {
    return *placed;
  }
  const PlacedScan& first = scans.front();
  const StationScan& scan = found->second;
  if (!scan.grid->nominal || !first.grid->nominal) {
    return std::nullopt;
  }
  const RigidTransform model_from_tablet =
      first.model_from_scanner * first.grid->nominal->tablet_from_scanner.inverse();
  return PlacedScan{id, scan.grid.get(), scan.flags.get(),
                    model_from_tablet * scan.grid->nominal->tablet_from_scanner, 0.0};
}

std::optional<NextView> PlanningStage::after_miss(const Rig& rig, int id) const {
  const std::optional<PlacedScan> there = where_driven(id);
  return there ? side_view(rig, {id, *drive_of(id)}, *there, model_surface(cleared_.scans()), 0.0)
               : std::nullopt;
}

std::optional<NextView> PlanningStage::laid_otherwise(const Rig& rig, std::span<const int> in_vain,
                                                      JobContext& job) const {
  constexpr double kElsewhereMm = 20;
  const double elsewhere = std::cos(rad_from_deg(25.0));
  const int id = in_vain.back();
  const std::optional<PlacedScan> there = where_driven(id);
  if (!there) {
    return std::nullopt;
  }
  const ModelSurface surface = model_surface(cleared_.scans());
  std::vector<ViewCandidate> candidates = rig_candidates(rig, {id, *drive_of(id)}, *there, surface);
  std::erase_if(candidates, [](const ViewCandidate& candidate) { return !candidate.by_hand; });
  for (const int one : in_vain) {
    if (const std::optional<PlacedScan> looked = where_driven(one)) {
      const RigidTransform& from = looked->model_from_scanner;
      std::erase_if(candidates, [&](const ViewCandidate& candidate) {
        const RigidTransform& to = candidate.model_from_scanner;
        return to.rotation.col(2).dot(from.rotation.col(2)) > elsewhere &&
               (to.translation_mm - from.translation_mm).norm() < kElsewhereMm;
      });
    }
  }
  NextViewOptions options;
  options.least_overlap = 0.5;
  options.ranked = 1;
  const Result<NextViews> views = next_views(candidates, ScannerModel::of(rig, noise_of(*there)), surface,
                                             targets_.targets, options, job);
  return views && !views->ranked.empty() ? std::optional(views->ranked.front()) : std::nullopt;
}

std::optional<NextView> PlanningStage::same_view(const Rig& rig, int id) const {
  constexpr double kLiesAsBefore = 0.17;    ///< rad: a hand that turns a tablet turns it farther
  constexpr double kLiesThereStillMm = 10;  ///< and pushes it farther than that
  const std::optional<PlacedScan> then = where_driven(id);
  std::optional<PlacedScan> now;
  for (auto scan = scans_.rbegin(); scan != scans_.rend() && !now; ++scan) {
    now = where_driven(scan->first);
  }
  if (!then || !now) {
    return std::nullopt;
  }
  const StageState state{now->id, *drive_of(now->id)};
  const Placement drive = *drive_of(id);
  const Eigen::Matrix3d lay = TabletOnStage::of({id, drive}, *then).stage_from_model;
  const Eigen::Matrix3d lies = TabletOnStage::of(state, *now).stage_from_model;
  // What turntable and tilt turn the scanner about; an arm looks about it.
  const auto apart_mm = [&](const RigidTransform& model_from_scanner) {
    return rig.robot ? 0.0
                     : (model_from_scanner.translation_mm - then->model_from_scanner.translation_mm).norm();
  };
  if (Eigen::AngleAxisd(lay * lies.transpose()).angle() < kLiesAsBefore &&
      apart_mm(now->model_from_scanner) < kLiesThereStillMm) {
    NextView view{then->model_from_scanner, 0.0, say_placement(rig, drive), drive};
    view.placement->hand_turn.reset();
    return view;
  }
  const auto off = [&](const ViewCandidate& candidate) {
    constexpr double kMmAsBadAsOneRad = 100;
    return Eigen::AngleAxisd(candidate.model_from_scanner.rotation.transpose() *
                             then->model_from_scanner.rotation)
               .angle() +
           apart_mm(candidate.model_from_scanner) / kMmAsBadAsOneRad;
  };
  const std::vector<ViewCandidate> candidates =
      rig_candidates(rig, state, *now, model_surface(cleared_.scans()));
  const auto nearest = std::ranges::min_element(candidates, {}, off);
  if (nearest == candidates.end()) {
    return std::nullopt;
  }
  return NextView{nearest->model_from_scanner, 0.0, nearest->say, nearest->placement};
}

std::optional<Placement> PlanningStage::drive_of(int id) const {
  const auto found = scans_.find(id);
  return found != scans_.end() ? found->second.drive : std::nullopt;
}

}  // namespace dubsar
