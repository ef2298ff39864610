// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/planning_stage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/tablet_frame.h"
#include "core/units.h"
#include "planning/clearing.h"
#include "planning/groups_apart.h"
#include "planning/model_faces.h"
#include "planning/red_change.h"
#include "planning/red_map.h"
#include "planning/sample_states.h"
#include "planning/side_view.h"
#include "station/near_mesh.h"
#include "station/stitch_warnings.h"

namespace dubsar {

namespace {

/// Online, a scan that moved by less than this part of µ stays where it is in the mesh, and what it cleared
/// stays cleared, until the final pass.
constexpr double kStaysWithin = 0.25;

/// The rim of a hole lies within so many µ of the mesh; an excused sample farther away hangs in the air.
constexpr double kRimInSpacings = 4.0;

bool same_placement(const Placement& a, const Placement& b) {
  constexpr double kSameRad = 1e-6;
  constexpr double kSameMm = 1e-3;
  const auto same = [=](const std::optional<RigidTransform>& p, const std::optional<RigidTransform>& q) {
    return p.has_value() == q.has_value() &&
           (!p || (p->rotation.isApprox(q->rotation, kSameRad) &&
                   (p->translation_mm - q->translation_mm).norm() < kSameMm));
  };
  return same(a.hand_turn, b.hand_turn) && same(a.free_pose, b.free_pose) &&
         std::abs(a.turntable_rad - b.turntable_rad) < kSameRad &&
         std::abs(a.tilt_rad - b.tilt_rad) < kSameRad;
}

}  // namespace

void PlanningStage::add(const StationScan& scan) {
  take_out(scan.id);  // nothing may refer to a grid that is replaced
  scans_[scan.id] = scan;
  flags_.add(scan);
}

void PlanningStage::take_out(int id) {
  cleared_.remove(id);
  stitcher_.remove(id);
  placed_.erase(id);
}

Status PlanningStage::place(const std::vector<ScanPose>& poses, bool exact, JobContext& job) {
  poses_ = poses;
  std::ranges::for_each(flags_.follow(poses), [this](int id) { take_out(id); });
  std::set<int> in_the_way;  // with all that they have: no part of the mesh, so none of the red map
  for (const ForeignFound& found : flags_.foreign()) {
    if (found.is_all()) {
      in_the_way.insert(found.id);
    }
  }
  std::map<int, PlacedScan> wanted;
  for (const ScanPose& pose : poses) {
    const auto scan = scans_.find(pose.id);
    if (pose.status == PoseStatus::kRegistered && scan != scans_.end() && !copied_from(copies(), pose.id) &&
        !in_the_way.contains(pose.id)) {
      wanted[pose.id] = {pose.id,
                         scan->second.grid.get(),
                         &flags_.of(pose.id),
                         pose.model_from_scanner,
                         pose.sigma_mm,
                         std::nullopt,
                         pose.locked};
    }
  }
  std::vector<int> gone;
  for (const auto& [id, there] : placed_) {
    if (!wanted.contains(id)) {
      gone.push_back(id);
    }
  }
  for (const int id : gone) {
    take_out(id);
  }
  const double tolerance = exact ? 0.0 : kStaysWithin;
  std::vector<ClearedMap::NewPose> followed;
  for (auto& [id, placed] : placed_) {
    const PlacedScan& scan = wanted.at(id);
    followed.push_back({id, scan.model_from_scanner, scan.sigma_mm});
    const double moved_mm =
        displacement_mm(placed.box_mm, placed.scan.model_from_scanner, scan.model_from_scanner);
    if (moved_mm > tolerance * scan.grid->spacing_mm || placed.scan.is_fixed != scan.is_fixed ||
        (exact && placed.scan.sigma_mm != scan.sigma_mm)) {
      stitcher_.remove(id);
      placed.scan = scan;
      placed.stitched = false;
    }
  }
  cleared_.reposition(followed, tolerance);
  std::size_t done = 0;
  for (const auto& [id, scan] : wanted) {
    job.progress("clearing", static_cast<double>(done++) / static_cast<double>(wanted.size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "planning was stopped");
    }
    if (!placed_.contains(id)) {
      cleared_.add(scan);
      placed_[id] = {scan, cleared_.box_mm(id), false};
    }
  }
  job.progress("clearing", 1.0);
  return {};
}

Status PlanningStage::stitch(JobContext& job) {
  std::size_t done = 0;
  for (auto& [id, placed] : placed_) {
    job.progress("stitching", static_cast<double>(done++) / static_cast<double>(placed_.size()));
    if (placed.stitched) {
      continue;
    }
    if (const Status added = stitcher_.add(placed.scan, job); !added) {
      return added;
    }
    placed.stitched = true;
  }
  job.progress("stitching", 1.0);
  return {};
}

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

bool PlanningStage::shows_much_more(int id) const {
  constexpr double kMuchMore = 1.3;
  const auto diagonal = [](std::span<const PlacedScan> scans) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : reach_points(scans)) {
      box.extend(p);
    }
    return box.isEmpty() ? 0.0 : box.diagonal().norm();
  };
  std::vector<PlacedScan> others = cleared_.scans();
  std::erase_if(others, [&](const PlacedScan& scan) { return scan.id == id; });
  const auto found = scans_.find(id);
  if (found == scans_.end() || others.empty()) {
    return false;
  }
  const PlacedScan alone{id, found->second.grid.get(), found->second.flags.get(), {}, 0.0};
  return diagonal({&alone, 1}) > kMuchMore * diagonal(others);
}

Result<Mesh> PlanningStage::mesh(JobContext& job) {
  if (const Status stitched = stitch(job); !stitched) {
    return std::unexpected(stitched.error());
  }
  return stitcher_.mesh(job);
}

std::vector<std::string> PlanningStage::warnings_of_mesh(std::map<int, std::string> names) const {
  std::erase_if(names, [&](const auto& scan) { return !placed_.contains(scan.first); });
  return warnings_of_places(stitcher_, names);
}

std::optional<ViewGain> PlanningStage::gain_of_new(std::span<const PlacedScan> scans) const {
  const PlacedScan* fresh = nullptr;
  for (const PlacedScan& scan : scans) {
    if (!mapped_.contains(scan.id)) {
      if (fresh != nullptr) {
        return std::nullopt;
      }
      fresh = &scan;
    }
  }
  if (fresh == nullptr || mapped_.empty()) {
    return std::nullopt;
  }
  ViewGain gain{fresh->id, std::nullopt, cleared_area_mm2(targets_, *fresh)};
  if (const auto& drive = scans_.at(fresh->id).drive) {
    const auto asked = std::ranges::find_if(proposed_, [&](const NextView& view) {
      return view.placement && same_placement(*view.placement, *drive);
    });
    if (asked != proposed_.end()) {
      gain.predicted_mm2 = asked->predicted_cleared_mm2;
    }
  }
  return gain;
}

Result<RedMap> PlanningStage::red_map(const Rig* rig, JobContext& job) {
  const std::vector<PlacedScan> scans = cleared_.scans();
  RedMapOptions options;
  options.stage = stage();
  // Without a mesh the scans themselves cast the shadows: as good, and it waits for no stitching.
  Result<RedMapResult> result = make_red_map(scans, nullptr, rig, options, job);
  if (!result) {
    return std::unexpected(result.error());
  }
  if (const std::optional<int> from = turns_go_from()) {
    for (NextView& view : result->map.next) {
      if (!view.placement || view.placement->hand_turn) {
        view.say = "from how it lay for scan " + std::to_string(*from) + ": " + view.say;
      }
    }
  }
  result->map.copies = copies();
  result->map.apart = groups_apart(poses_, scans);
  last_gain_ = gain_of_new(scans);
  if (last_gain_) {
    gains_.push_back(*last_gain_);
  }
  proposed_ = result->map.next;
  mapped_.clear();
  for (const PlacedScan& scan : scans) {
    mapped_.insert(scan.id);
  }
  excused_flags_ = std::move(result->flags);
  targets_ = std::move(result->targets);
  return std::move(result->map);
}

ColouredPoints PlanningStage::red_points(const Mesh& mesh) const {
  ColouredPoints points;
  const std::vector<PlacedScan> scans = cleared_.scans();
  double spacing_mm = 0;
  for (const PlacedScan& scan : scans) {
    spacing_mm = std::max(spacing_mm, scan.grid->spacing_mm);
  }
  const NearMesh near(mesh, static_cast<float>(kRimInSpacings * spacing_mm));
  for (std::size_t k = 0; k < scans.size() && k < excused_flags_.size(); ++k) {
    const RangeGrid& grid = *scans[k].grid;
    // As wide as the gap that it stands beside: a thin rim would hardly show.
    points.radius_mm = std::max(points.radius_mm, static_cast<float>(1.5 * grid.spacing_mm));
    points.bury_mm = std::max(points.bury_mm, static_cast<float>(2.0 * grid.spacing_mm));
    const SampleStates states =
        sample_states(grid, excused_flags_[k], {}, targets_, static_cast<std::uint32_t>(k));
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const SampleState state = states.state[i];
      const bool red = state == SampleState::kRed;
      if (!red && state != SampleState::kInterpolated && state != SampleState::kUnreachable) {
        continue;
      }
      const Eigen::Vector3f p = (scans[k].model_from_scanner * grid.point(i).cast<double>()).cast<float>();
      if (red || near.has(p)) {
        points.positions_mm.push_back(p);
        points.colours.push_back(red ? kRedOfSparse : kAmberOfExcused);
      }
    }
  }
  return points;
}

std::optional<SampleStates> PlanningStage::states(int id) const {
  const std::vector<PlacedScan> scans = cleared_.scans();
  for (std::size_t k = 0; k < scans.size() && k < excused_flags_.size(); ++k) {
    if (scans[k].id == id) {
      return sample_states(*scans[k].grid, excused_flags_[k], cleared_.cleared_by(id), targets_,
                           static_cast<std::uint32_t>(k));
    }
  }
  return std::nullopt;
}

RigidTransform PlanningStage::tablet_from_model(const Mesh& mesh) const {
  const std::vector<PlacedScan> scans = cleared_.scans();
  const RigidTransform named{model_faces(scans, mesh.positions).model_from_faces.transpose(),
                             Eigen::Vector3d::Zero()};
  // The faces have their names; the tablet's own shape sets them straight (it was laid down by hand).
  Mesh turned;
  turned.faces = mesh.faces;
  turned.positions.reserve(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) {
    turned.positions.emplace_back((named * p.cast<double>()).cast<float>());
  }
  return tablet_frame(turned) * named;
}

}  // namespace dubsar
