// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "planning/sparse_flags.h"

namespace dubsar::bench {

namespace {

/// What registration would leave of the poses' errors, when they are taken from the truth.
constexpr double kPoseSigmaMm = 0.01;

[[noreturn]] void give_up(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  std::exit(2);
}

}  // namespace

ClosedLoop::ClosedLoop(const LoopOptions& options) : options_(options) {
  JobContext job;
  auto tablet = sim::make_tablet(options.tablet, job);
  if (!tablet) {
    give_up(tablet.error());
  }
  station_ = std::make_unique<sim::SimStation>(std::move(*tablet), options.station);
  truth_ = std::make_unique<TabletTruth>(station_->tablet(), station_->query(), options.station.scanner,
                                         options.station.tilt_max_deg, options.truth_points);
  rig_ = station_->rig();
  sampled_.assign(truth_->size(), 0);
}

RigidTransform ClosedLoop::tablet_from_model() const {
  if (!options_.registered) {
    return {};
  }
  for (const PlacedScan& scan : cleared_.scans()) {
    return true_poses_[static_cast<std::size_t>(scan.id)] * scan.model_from_scanner.inverse();
  }
  return {};
}

std::vector<double> ClosedLoop::pose_errors_mm() const {
  const RigidTransform frame = tablet_from_model();
  std::vector<double> errors;
  for (const PlacedScan& scan : cleared_.scans()) {
    const RigidTransform& truth = true_poses_[static_cast<std::size_t>(scan.id)];
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < scan.grid->size(); i += 97) {
      if (scan.grid->valid[i] != 0) {
        const Eigen::Vector3d p = scan.grid->point(i).cast<double>();
        squares += (frame * (scan.model_from_scanner * p) - truth * p).squaredNorm();
        ++count;
      }
    }
    errors.push_back(count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0);
  }
  return errors;
}

bool ClosedLoop::scan(const std::optional<Placement>& placement) {
  JobContext job;
  if (placement) {
    if (const Status moved = station_->move(*placement); !moved) {
      give_up(moved.error());
    }
    last_ = *placement;
    last_.hand_turn.reset();
  }
  auto grid = station_->scan_grid(job);
  if (!grid) {
    give_up(grid.error());
  }
  const int id = scans();
  grids_.push_back(std::make_shared<const RangeGrid>(std::move(*grid)));
  true_poses_.push_back(station_->true_tablet_from_scanner());
  const SampleFlags flags = flag_sparse(*grids_.back());
  if (options_.registered) {
    const ScanPose pose = registrar_.add(id, grids_.back(), nullptr, job);
    for (const ScanPose& other : registrar_.poses()) {
      if (cleared_.contains(other.id)) {
        cleared_.reposition(other.id, other.model_from_scanner, other.sigma_mm);
      }
    }
    if (pose.status != PoseStatus::kRegistered) {
      return false;
    }
    cleared_.add({id, grids_.back().get(), &flags, pose.model_from_scanner, pose.sigma_mm});
  } else {
    cleared_.add({id, grids_.back().get(), &flags, true_poses_.back(), kPoseSigmaMm});
  }
  const std::vector<std::uint8_t> sampled =
      truth_->sampled_by({id, grids_.back().get(), &flags, true_poses_.back(), 0.0});
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    sampled_[i] |= sampled[i];
  }
  return true;
}

RedMapResult ClosedLoop::red_map() {
  JobContext job;
  RedMapOptions options;
  options.stage = stage();
  auto result = make_red_map(cleared_.scans(), nullptr, &rig_, options, job);
  if (!result) {
    give_up(result.error());
  }
  return std::move(*result);
}

double ClosedLoop::share_sampled() const {
  return static_cast<double>(std::count(sampled_.begin(), sampled_.end(), 1)) /
         static_cast<double>(sampled_.size());
}

}  // namespace dubsar::bench
