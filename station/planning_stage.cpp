// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/planning_stage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/tablet_frame.h"
#include "planning/clearing.h"
#include "planning/groups_apart.h"
#include "planning/model_faces.h"
#include "planning/red_change.h"
#include "planning/red_map.h"
#include "planning/sample_states.h"
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
      if (!view.placement || view.placement->hand_turn || !options.stage) {
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
