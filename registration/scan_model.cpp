// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/scan_model.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"
#include "registration/align_near.h"
#include "registration/pin_detection.h"
#include "registration/pin_labels.h"
#include "registration/pin_matching.h"
#include "registration/pin_merge.h"
#include "registration/unit_check.h"
#include "registration/without_foreign.h"

namespace dubsar {

namespace {

constexpr const char* kOtherGroup =
    "it fits other scans, but not the largest group; scan what connects them, with at least 30 % overlap, or "
    "take it out where it is of another tablet";

/// Samples farther apart than this part of the scale show neither what is written nor the finer shape: with
/// 0.020 the bunny and written tablets are registered, with 0.030 hardly any.
constexpr double kCoarsestSpacing = 0.025;

/// A pose that the surfaces hold no better than this (ScanPose::sigma_mm) is none to measure by, even where
/// the relief seemed to settle it: on a smooth ball the fall of the samples towards its rim passes for
/// relief. Scans with an edge or something written in the overlap are held to a small part of it.
constexpr double kLoosestMm = 0.5;
constexpr double kLoosestSpacings = 3.0;

/// Why a scan that found no place may have found none; empty where it is fine enough.
std::string too_coarse(double spacing_mm, double scale_mm) {
  if (!(scale_mm > 0) || spacing_mm <= kCoarsestSpacing * scale_mm) {
    return {};
  }
  return "too coarse for this object: samples every " + short_text(spacing_mm, 2) +
         " mm, where it needs at most " + short_text(kCoarsestSpacing * scale_mm, 2) +
         " mm; scan it with a smaller spacing";
}

/// True when the pins alone leave no doubt that the first match is the right one.
bool pins_tell(const std::vector<PinMatch>& matches) {
  constexpr double kMostChance = 1e-4;
  constexpr double kLeastLead = 10.0;  // of the log likelihood, against the next match
  const PinMatch& first = matches.front();
  const bool enough = first.labels_agree >= 3 || (first.pairs.size() >= 5 && first.chance < kMostChance);
  return enough && (matches.size() < 2 || matches[1].score < first.score - kLeastLead);
}

}  // namespace

void ScanModel::enter(int id, const RangeGrid* grid, const PinSet* pins) {
  Scan scan;
  scan.group = next_group_++;
  const RangeGrid empty;
  const RangeGrid& g = grid != nullptr ? *grid : empty;
  scan.file = g.source;
  scan.nominal = g.nominal;
  if (scan.nominal && !scan.nominal->tablet_from_scanner.is_rigid()) {
    scan.nominal.reset();
  }
  std::vector<std::uint8_t> ignore;
  const double tip_mm = pins != nullptr ? pins->tip_diameter_mm : g.pin_tip_diameter_mm;
  scan.pins_expected = tip_mm > 0;
  if (scan.pins_expected) {
    const PinDetection detection = detect_pins(g, tip_mm, {});
    scan.pins = detection.tips;
    ignore = detection.mask;
    if (pins != nullptr && pins->tips.contains(id)) {
      scan.pins = labelled_tips(detection.tips, pins->tips.at(id), tip_mm);
    }
  }
  scan.own_scale_mm = surface_scale_mm(g);
  if (!std::isfinite(scan.own_scale_mm)) {
    scan.own_scale_mm = 0;
  }
  const ScanSize size{scan.own_scale_mm, g.spacing_mm > 0 ? g.spacing_mm : estimate_spacing_mm(g)};
  const std::string impossible = impossible_size(size, options_.least_size_mm, options_.most_size_mm);
  if (scale_mm_ == 0 && impossible.empty()) {
    scale_mm_ = scan.own_scale_mm;
    first_spacing_mm_ = size.spacing_mm;
  }
  const ScanSize before{scale_mm_, first_spacing_mm_};
  if (impossible.empty() && size.scale_mm > kMuchLarger * before.scale_mm &&
      (same_spacing(size, before) || (is_all_apart() && sizes_agree(size, before, options_.most_unit_ratio) &&
                                      perhaps_other_unit(size, before).empty()))) {
    rescale(size.scale_mm);
    first_spacing_mm_ = size.spacing_mm;
  }
  ScanSurfaceOptions surface = options_.surface;
  surface.scale_mm = scale_mm_;
  if (scan.nominal) {
    scan.group_from_scanner = scan.nominal->tablet_from_scanner.orthonormalised();
  }
  if (!(scan.own_scale_mm > 0)) {
    scan.reason = "the scan has no surface in it; scan it again";
  } else if (scale_mm_ > 0 && !sizes_agree(size, before, options_.most_unit_ratio)) {
    scan.reason = other_unit(size, before);
    if (impossible.empty()) {
      surface.scale_mm = size.scale_mm;
      scan.waiting = make_scan_surface(g, ignore, surface);
    }
  } else if (!impossible.empty()) {
    scan.reason = impossible;
  } else {
    give_surface(scan, make_scan_surface(g, ignore, surface), size, before);
  }
  scans_[id] = std::move(scan);
}

bool ScanModel::is_all_apart() const {
  return std::ranges::all_of(scans_,
                             [&](const auto& item) { return members(item.second.group).size() <= 1; });
}

std::vector<int> ScanModel::members(int group) const {
  std::vector<int> out;
  for (const auto& [id, scan] : scans_) {
    if (scan.usable && scan.group == group) {
      out.push_back(id);
    }
  }
  return out;
}

std::vector<int> ScanModel::groups_by_size() const {
  std::map<int, std::vector<int>> ids_of;
  for (const auto& [id, scan] : scans_) {
    if (scan.usable) {
      ids_of[scan.group].push_back(id);
    }
  }
  std::map<int, std::pair<std::size_t, int>> size_and_first;  // group -> (measurements, lowest id)
  std::vector<int> out;
  out.reserve(ids_of.size());
  for (const auto& [group, ids] : ids_of) {
    size_and_first[group] = {measurements(ids), ids.front()};
    out.push_back(group);
  }
  std::stable_sort(out.begin(), out.end(), [&](int a, int b) {
    const auto& [size_a, first_a] = size_and_first[a];
    const auto& [size_b, first_b] = size_and_first[b];
    return size_a != size_b ? size_a > size_b : first_a < first_b;
  });
  // As long as nothing is registered with anything, a scan that was broken off must not be the model.
  if (!out.empty() && size_and_first[out.front()].first == 1) {
    const auto scale_mm = [&](int group) { return scans_.at(size_and_first[group].second).own_scale_mm; };
    const auto largest =
        std::max_element(out.begin(), out.end(), [&](int a, int b) { return scale_mm(a) < scale_mm(b); });
    if (scale_mm(*largest) > kMuchLarger * scale_mm(out.front())) {
      std::rotate(out.begin(), largest, largest + 1);
    }
  }
  return out;
}

int ScanModel::main_group() const {
  const std::vector<int> groups = groups_by_size();
  for (const int group : groups) {
    const std::vector<int> ids = members(group);
    if (std::any_of(ids.begin(), ids.end(), [&](int i) { return scans_.at(i).is_locked(); })) {
      return group;  // what the operator has fixed is the model, however little it is
    }
  }
  // A scan that was taken out is not what others are tried on, while there is another.
  const auto sound = std::find_if(groups.begin(), groups.end(), [&](int group) {
    const std::vector<int> ids = members(group);
    return std::any_of(ids.begin(), ids.end(), [&](int i) { return scans_.at(i).fault_reason.empty(); });
  });
  return sound != groups.end() ? *sound : groups.empty() ? -1 : groups.front();
}

std::vector<ModelScan> ScanModel::model_of(const std::vector<int>& ids) const {
  std::vector<ModelScan> out;
  out.reserve(ids.size());
  for (const int id : ids) {
    const Scan& scan = scans_.at(id);
    out.push_back({scan.features.surface.get(), scan.group_from_scanner});
  }
  return out;
}

std::vector<const ScanFeatures*> ScanModel::features_of(const std::vector<int>& ids) const {
  std::vector<const ScanFeatures*> out;
  out.reserve(ids.size());
  for (const int id : ids) {
    out.push_back(&scans_.at(id).features);
  }
  return out;
}

PoseHints ScanModel::hints_for(const Scan& scan, const std::vector<int>& group_ids) const {
  PoseHints hints;
  std::optional<RigidTransform> group_from_tablet;
  std::vector<PlacedPins> pins;
  for (const int id : group_ids) {
    const Scan& other = scans_.at(id);
    if (scan.nominal && other.nominal) {
      const RigidTransform frame = other.group_from_scanner * other.nominal->tablet_from_scanner.inverse();
      if (!group_from_tablet) {
        group_from_tablet = frame;
      }
      if (!hints.stage && other.nominal->placement == scan.nominal->placement) {
        hints.stage = (frame * scan.nominal->tablet_from_scanner).orthonormalised();
        hints.stage_sigma_mm = std::hypot(scan.nominal->sigma_mm, other.nominal->sigma_mm);
        hints.stage_sigma_rad = std::hypot(scan.nominal->sigma_rad, other.nominal->sigma_rad);
      }
    }
    pins.push_back({other.pins, other.group_from_scanner, measured_as(group_ids, id)});
  }
  const std::vector<PinMatch> matches = match_pins(scan.pins, merged_pins(pins), {});
  for (std::size_t k = 0; k < matches.size(); ++k) {
    const bool told = k == 0 && pins_tell(matches);
    (told ? hints.told : hints.starts).push_back(matches[k].target_from_source);
    if (k == 0 && !told && matches[k].labels_agree >= PinMatchOptions{}.least_labelled) {
      hints.named.push_back(matches[k].target_from_source);
    }
  }
  if (group_from_tablet && !hints.stage) {
    hints.asked = (*group_from_tablet * scan.nominal->tablet_from_scanner).orthonormalised();
    hints.hand_sigma_mm = scan.nominal->hand_sigma_mm;
    hints.hand_sigma_rad = scan.nominal->hand_sigma_rad;
  }
  return hints;
}

bool ScanModel::place(int as, const RigidTransform& model_from_as, bool locked, JobContext& job) {
  if (const std::optional<int> other = locked_as(as); other && *other != as) {
    return locked && lock_at(as, model_from_as);
  }
  const RigidTransform model_from_scanner = scan_placed(as, model_from_as);
  const int id = stands_as(as);
  const auto found = scans_.find(id);
  if (found == scans_.end() || !found->second.usable) {
    return false;
  }
  Scan& scan = found->second;
  const bool apart = leave(id);
  scan.fault_reason.clear();
  int main = main_group();
  for (const int group : groups_by_size()) {
    if (main == scan.group && group != main) {
      main = group;
      break;
    }
  }
  scan.locked_as = locked ? std::set{as} : std::set<int>{};
  const std::vector<int> ids = scan.group == main ? std::vector<int>{} : members(main);
  const std::vector<ModelScan> model = model_of(ids);
  if (locked || ids.empty()) {
    scan.group = main;
    scan.group_from_scanner = model_from_scanner;
    keep_pose(as, model_from_as);
    scan.reason.clear();
    if (!ids.empty()) {
      const ModelFit fit =
          judge_in_model(*scan.features.surface, model, model_from_scanner, options_.search.fit);
      std::vector<std::pair<int, int>> pairs;
      pairs.reserve(fit.touching.size());
      for (const std::size_t k : fit.touching) {
        pairs.push_back(std::minmax(id, ids[k]));
      }
      measure_pairs(pairs);
    }
    settle_group(main, job);
    judge(id);
    retry(job);
    return true;
  }
  AlignNearOptions near;
  near.fit = options_.search.fit;
  near.fit.least_significance = 0;  // the operator speaks for it
  near.verify = options_.search.verify;
  std::vector<ModelFit> fits = align_near(*scan.features.surface, model, model_from_scanner, near);
  for (ModelFit& fit : fits) {
    fit.told = true;
  }
  const PoseVerdict verdict = verify_pose(fits, options_.search.verify);
  FoundPose fitted{std::move(fits), verdict};
  WithoutForeign without_foreign(*this, id, ids);
  if (verdict.status != PoseStatus::kRegistered && !without_foreign.settles(fitted)) {
    scan.reason = "the hint led to no certain pose: " + verdict.reason;
    scan.outcome = verdict.status;
    if (apart) {
      retry(job);
    }
    return false;
  }
  without_foreign.keep();
  connect(id, fitted.fits.front(), false, ids, main);
  settle_group(scan.group, job);
  judge(id);
  retry(job);
  return true;
}

ScanPins ScanModel::pins_of(int id) const {
  const Scan& scan = scans_.at(id);
  ScanPins pins{id, scan.pins, {0, 0, 0}, 0.5 * scan.own_scale_mm};
  if (scan.features.surface) {
    pins.surface_center_mm = scan.features.surface->centroid_mm;
    pins.surface_radius_mm = 0.5 * scan.features.surface->extent_mm;
  }
  return pins;
}

ScanPose ScanModel::pose(int as) const {
  const int id = stands_as(as);
  const Scan& scan = scans_.at(id);
  ScanPose out;
  out.id = as;
  out.file = id == as ? scan.file : copies_.at(as).file;
  out.model_from_scanner = group_from(as);
  out.locked = scan.locked_as.contains(as);
  out.rms_mm = scan.rms_mm;
  out.overlap = scan.overlap;
  if (!scan.usable || scan.group != main_group()) {
    // Its own parts are no other scans that it fits.
    const bool in_group = scan.usable && measurements(members(scan.group)) > 1;
    out.status = in_group ? PoseStatus::kUnsure : scan.outcome;
    if (in_group) {
      out.group_apart = members(scan.group).front();
    }
    out.reason = in_group                     ? kOtherGroup
                 : !scan.fault_reason.empty() ? scan.fault_reason
                 : !scan.suspicion.empty()    ? scan.suspicion
                                              : too_coarse(scan.own_spacing_mm, scale_mm_);
    if (out.reason.empty()) {
      out.reason = scan.reason;
    }
    if (!scan.hint_reason.empty()) {
      out.reason = scan.hint_reason;
    }
    if (out.reason.empty()) {
      out.reason = "it was not tried; run registration again";
    }
    out.reason = beside_pins(id, out.reason, true);
    return out;
  }
  out.status = PoseStatus::kRegistered;
  out.warning = scan.warning;
  out.covariance = scan.covariance;
  // Mean square displacement over points at rms radius r about the centroid: trace of the shift plus two
  // thirds of r² times that of the turn.
  const double radius_mm = 0.5 * scan.features.surface->extent_mm;
  const double shifted = scan.covariance.bottomRightCorner<3, 3>().trace();
  const double turned = 2.0 / 3.0 * radius_mm * radius_mm * scan.covariance.topLeftCorner<3, 3>().trace();
  out.sigma_mm = std::max(std::sqrt(std::max(0.0, shifted + turned)), scan.stage_sigma_mm);
  const bool told = scan.is_locked() || scan.stage_sigma_mm > 0;
  if (!told && out.sigma_mm > std::max(kLoosestMm, kLoosestSpacings * scan.features.surface->spacing_mm)) {
    out.status = PoseStatus::kUnsure;
    out.reason = beside_pins(id, too_even(turned > shifted), false);
  }
  return out;
}

}  // namespace dubsar
