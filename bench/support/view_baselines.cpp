// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/view_baselines.h"

#include <algorithm>
#include <set>

#include "core/parallel.h"
#include "core/units.h"
#include "planning/model_surface.h"
#include "planning/view_candidates.h"
#include "planning/view_prediction.h"

namespace dubsar::bench {

namespace {

constexpr double kShadowMarginMm = 0.02;

std::vector<ViewCandidate> candidates_now(ClosedLoop& loop, const ModelSurface& surface) {
  const std::vector<PlacedScan> placed = loop.placed();
  return rig_candidates(loop.rig(), loop.stage(), placed.back(), surface);
}

}  // namespace

int greedy_cover(const LoopOptions& options, double share, double least_overlap, int max_scans) {
  LoopOptions own = options;
  own.registered = false;
  ClosedLoop loop(own);
  loop.scan(std::nullopt);
  loop.station().set_hand_error(0, 0);  // from here on it knows how a turn comes out
  const auto& truth = loop.truth();
  const std::size_t n = truth.size();
  // Every fourth point tells views apart well enough.
  constexpr std::size_t kStride = 4;
  // A point that a view sees by rays and its scan does not sample counts less with each view that tries.
  std::vector<std::uint8_t> tries(n, 0);
  while (loop.share_sampled() < share && loop.scans() < max_scans) {
    const std::vector<PlacedScan> placed = loop.placed();
    const ModelSurface surface = model_surface(placed);
    const std::vector<ViewCandidate> candidates = candidates_now(loop, surface);
    const bool fine = loop.share_sampled() > 0.98;
    const ScannerModel scanner = ScannerModel::of(loop.rig(), loop.scanner().noise_mm);
    std::vector<double> gain(candidates.size(), 0);
    std::vector<double> known(candidates.size(), 0);
    parallel_for_each_index(
        candidates.size(),
        [&](std::size_t c) {
          const ViewPredictor view(scanner, candidates[c].model_from_scanner, loop.station().query(),
                                   kShadowMarginMm, candidates[c].hidden);
          for (std::size_t i = c % kStride; i < n; ++i) {
            // Unsampled points count each once few are left; sampled ones are thinned.
            const bool open = loop.sampled()[i] == 0;
            if (i % kStride != c % kStride && !(open && fine)) {
              continue;
            }
            const double weight = (open && fine ? 1.0 : static_cast<double>(kStride)) / (1 + 3 * tries[i]);
            if (view.chance(truth.points()[i].cast<double>(), truth.normals()[i].cast<double>()) > 0.5) {
              (open ? gain : known)[c] += weight;
            }
          }
        },
        1);
    std::size_t best = candidates.size();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const bool overlaps = known[c] >= least_overlap * (known[c] + gain[c]);
      if (overlaps && gain[c] > 0 && (best == candidates.size() || gain[c] > gain[best])) {
        best = c;
      }
    }
    if (best == candidates.size()) {
      return max_scans;
    }
    loop.scan(candidates[best].placement);
    const ViewPredictor view(scanner, candidates[best].model_from_scanner, loop.station().query(),
                             kShadowMarginMm, candidates[best].hidden);
    for (std::size_t i = 0; i < n; ++i) {
      if (loop.sampled()[i] == 0 &&
          view.chance(truth.points()[i].cast<double>(), truth.normals()[i].cast<double>()) > 0.5) {
        tries[i] = static_cast<std::uint8_t>(std::min(tries[i] + 1, 200));
      }
    }
  }
  return loop.scans();
}

int uniform_turntable(const LoopOptions& options, int max_scans) {
  constexpr int kSteps = 8;
  ClosedLoop loop(options);
  loop.scan(std::nullopt);
  std::set<Face> done;
  while (loop.scans() < max_scans) {
    for (int k = 0; k < kSteps && loop.scans() < max_scans; ++k) {
      loop.scan(Placement{2 * kPi * k / kSteps, rad_from_deg(45.0), std::nullopt});
      if (loop.red_map().map.conclusive) {
        return loop.scans();
      }
    }
    const ModelSurface surface = model_surface(loop.placed());
    const PlacedScan last = loop.placed().back();
    const RigidTransform stage_from_model =
        stage_from_scanner(loop.stage().drive.turntable_rad, loop.stage().drive.tilt_rad, {0, 0, 0}) *
        last.model_from_scanner.inverse();
    done.insert(surface.faces.of(stage_from_model.rotation.transpose() * Eigen::Vector3d::UnitZ()));
    // The side that lies opposite first, then the others.
    std::optional<Placement> turn;
    double most = -2;
    for (const ViewCandidate& c : rig_candidates(loop.rig(), loop.stage(), last, surface)) {
      if (!c.by_hand || std::abs(c.placement->tilt_rad) > 1e-6) {
        continue;
      }
      const Eigen::Vector3d up = stage_from_model.rotation.transpose() *
                                 c.placement->hand_turn->rotation.transpose() * Eigen::Vector3d::UnitZ();
      const double angle = Eigen::AngleAxisd(c.placement->hand_turn->rotation).angle();
      if (!done.contains(surface.faces.of(up)) && angle > most) {
        most = angle;
        turn = c.placement;
      }
    }
    if (!turn) {
      done.clear();
      continue;
    }
    loop.scan(turn);
  }
  return loop.scans();
}

int boundary_following(const LoopOptions& options, int max_scans) {
  ClosedLoop loop(options);
  loop.scan(std::nullopt);
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> looked;  ///< at a place, from a direction
  while (loop.scans() < max_scans) {
    const RedMapResult red = loop.red_map();
    if (red.map.conclusive) {
      break;
    }
    const ModelSurface surface = model_surface(loop.placed());
    const std::vector<ViewCandidate> candidates = candidates_now(loop, surface);
    const ScannerModel scanner = ScannerModel::of(loop.rig(), loop.scanner().noise_mm);
    const ViewCandidate* best = nullptr;
    const RedRegion* at = nullptr;
    for (const RedRegion& region : red.map.regions) {
      double nearest = -2;
      for (const ViewCandidate& c : candidates) {
        const Eigen::Vector3d towards = c.model_from_scanner.rotation * -scanner.view.direction;
        const bool again = std::any_of(looked.begin(), looked.end(), [&](const auto& l) {
          return (l.first - region.center_mm).norm() < 2.0 && l.second.dot(towards) > 0.98;
        });
        const bool below = c.hidden && c.hidden->normal.dot(region.center_mm) < c.hidden->offset_mm;
        if (region.state == RegionState::kRed && !again && !below && towards.dot(region.normal) > nearest) {
          nearest = towards.dot(region.normal);
          best = &c;
          at = &region;
        }
      }
      if (best != nullptr) {
        break;
      }
    }
    if (best == nullptr) {
      return max_scans;
    }
    looked.emplace_back(at->center_mm, best->model_from_scanner.rotation * -scanner.view.direction);
    loop.scan(best->placement);
  }
  return loop.scans();
}

}  // namespace dubsar::bench
