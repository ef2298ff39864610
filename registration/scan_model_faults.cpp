// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How a scan is found during which something moved, or whose lengths or pins are not those of the others.
#include <algorithm>
#include <cmath>

#include "core/log.h"
#include "core/parallel.h"
#include "registration/pin_advice.h"
#include "registration/pin_contradiction.h"
#include "registration/scan_model.h"
#include "registration/scan_motion.h"
#include "registration/scan_stretch.h"

namespace dubsar {

void ScanModel::put_out_faulty(JobContext& job) {
  std::set<int> candidates;
  candidates.swap(unchecked_);
  while (true) {
    if (job.cancelled()) {
      unchecked_.merge(candidates);  // for the next time
      return;
    }
    std::optional<Fault> worst;
    int worst_id = -1;
    for (const int id : candidates) {
      const std::optional<Fault> fault = fault_of(id);
      if (fault && (!worst || fault->gained > worst->gained)) {
        worst = fault;
        worst_id = id;
      }
    }
    if (!worst) {
      return;
    }
    candidates.erase(worst_id);
    Scan& scan = scans_.at(worst_id);
    const int group = scan.group;
    const bool apart = leave(worst_id);
    const std::vector<int> rest = members(group);
    scan.fault_reason = worst->reason;
    scan.has_moved = true;
    scan.fault_reason += only_one(rest, worst_id);
    scan.outcome = PoseStatus::kUnsure;
    scan.leads.clear();
    // Tried again when there is a scan that it has not met: the other one may be the one that moved.
    for (const auto& [other, unused] : scans_) {
      scan.tried_on.insert(other);
    }
    settle_group(group, job);
    for (const int other : rest) {
      judge(other);
    }
    if (apart) {
      retry(job);
      candidates.merge(unchecked_);
      unchecked_.clear();
      candidates.erase(worst_id);
    }
  }
}

std::optional<ScanModel::Fault> ScanModel::fault_of(int id) {
  const auto found = scans_.find(id);
  if (found == scans_.end() || !found->second.usable || found->second.is_locked()) {
    return std::nullopt;
  }
  const std::optional<InGroup> placed = in_group(id);
  if (!placed) {
    return std::nullopt;
  }
  const auto& [scan, others, fit] = *placed;
  const ScanSurface& surface = *scan.surface;
  const std::vector<ModelScan> model = model_scans(others);
  const std::optional<ScanMotion> motion =
      find_motion(surface, model, fit, options_.search.fit, found->second.has_moved);
  if (!motion) {
    found->second.has_moved = false;
    return std::nullopt;
  }
  // Bands of another tablet lie each where they fit best, too.
  const std::string or_another = sure(fit, options_.search.verify) ? "" : "; or it is of another tablet";
  // Rows that drift apart one by one look as if something had moved, too. A slip sideways looks sheared in
  // its turn: one of 0.9 mm in a scan of 24 mm by 4.8 %, where a stage 2 degrees out of square shears by 3.5.
  constexpr double kMostDrift = 0.04;
  const std::optional<ScanStretch> stretch = find_stretch(surface, model, fit);
  const bool slipped = stretch && stretch->is_rather_sheared() && std::abs(stretch->shear) > kMostDrift;
  if (stretch && stretch->is_off() && !slipped) {
    ModelFit mended = fit;
    mended.model_from_scanner = stretch->model_from_mended;
    if (!find_motion(*stretch->mended, model, mended, options_.search.fit)) {
      return Fault{motion->gained, reason_of(*stretch) + or_another};
    }
  }
  return Fault{motion->gained, reason_of(*motion) + or_another};
}

void ScanModel::warn() {
  for (auto& [id, scan] : scans_) {
    scan.warning.clear();
  }
  const std::vector<int> ids = members(main_group());
  warn_of_stretched(ids, warn_of_steps(ids));
  warn_of_pins(ids);
  for (const int id : ids) {
    if (const std::string& warning = scans_.at(id).warning; !warning.empty()) {
      log_warning(name_of(id) + ": " + warning);
    }
  }
}

std::string ScanModel::beside_pins(int id, std::string reason, bool advise) const {
  const Scan& scan = scans_.at(id);
  if (!scan.pins_expected) {
    return reason;
  }
  std::vector<ScanPins> others;
  for (const auto& [other_id, other] : scans_) {
    if (other_id != id && other.usable && other.group == main_group()) {
      others.push_back(pins_of(other_id));
    }
  }
  const PinAdvice advice = advise_pins(pins_of(id), others);
  std::string said = std::move(reason);
  if (std::ranges::any_of(scan.pins, [](const SeenPin& pin) { return pin.label >= 0; })) {
    std::string without = without_pins_advised(said);
    const bool advised = without != said;
    said = std::move(without);
    // They tell about where it lies, which is not what it lacks.
    said +=
        advised && advice.fault == PinFault::kNone ? "; its pins, put back by hand, hold it no better" : "";
  }
  return said + (!advise || advice.say.empty() ? "" : "; " + advice.say);
}

void ScanModel::warn_of_pins(const std::vector<int>& ids) {
  std::vector<ScanPinsInModel> pins;
  pins.reserve(ids.size());
  for (const int id : ids) {
    pins.push_back({id, scans_.at(id).pins, scans_.at(id).group_from_scanner, whole_among(ids, id)});
  }
  const std::vector<std::string> said = contradicted_labels(pins);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    add_warning(ids[k], said[k]);
  }
}

void ScanModel::warn_of_stretched(const std::vector<int>& ids, std::vector<int> sound) {
  std::vector<std::optional<ScanStretch>> stretches(ids.size());
  parallel_for_each_index(
      ids.size(),
      [&](std::size_t k) {
        const std::optional<InGroup> placed = in_group(ids[k]);
        if (!placed) {
          return;
        }
        const ScanSurface& surface = *placed->scan.surface;
        const std::vector<ModelScan> model = model_scans(placed->others);
        if (may_be_stretched(surface, model, placed->fit)) {
          stretches[k] = find_stretch(surface, model, placed->fit);
        }
      },
      1);
  // The worst first: what a scan shows against one that is off may be that one's.
  std::vector<std::size_t> accused;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (stretches[k] && stretches[k]->is_off() && std::ranges::find(sound, ids[k]) != sound.end()) {
      accused.push_back(k);
    }
  }
  std::ranges::stable_sort(accused, std::ranges::greater{},
                           [&](std::size_t k) { return stretches[k]->largest(); });
  for (const std::size_t k : accused) {
    if (sound.size() < ids.size()) {
      const InGroup placed = placed_among(ids[k], sound);
      const std::optional<ScanStretch> alone =
          find_stretch(*placed.scan.surface, model_scans(placed.others), placed.fit);
      if (alone && alone->acquits_of(*stretches[k])) {
        continue;
      }
    }
    std::erase(sound, ids[k]);
    add_warning(ids[k], reason_of(*stretches[k]) + only_one(ids, ids[k]));
  }
}

std::vector<int> ScanModel::warn_of_steps(const std::vector<int>& ids) {
  std::vector<std::optional<ScanStep>> steps(ids.size());
  parallel_for_each_index(
      ids.size(),
      [&](std::size_t k) {
        if (const std::optional<InGroup> placed = in_group(ids[k])) {
          steps[k] = find_step(*placed->scan.surface, model_scans(placed->others), placed->fit);
        }
      },
      1);
  const auto is_told = [&](const std::optional<ScanStep>& step, int id) {
    return step && step->is_told(scans_.at(id).features.surface->fine->spacing_mm);
  };
  // The worst first: beside a scan that moved, others look moved, too.
  std::vector<std::size_t> accused;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (is_told(steps[k], ids[k])) {
      accused.push_back(k);
    }
  }
  std::ranges::stable_sort(accused, std::ranges::greater{}, [&](std::size_t k) { return steps[k]->chi2; });
  std::vector<int> still = ids;
  for (const std::size_t k : accused) {
    if (still.size() < ids.size()) {
      const InGroup placed = placed_among(ids[k], still);
      steps[k] = find_step(*placed.scan.surface, model_scans(placed.others), placed.fit);
    }
    if (is_told(steps[k], ids[k])) {
      std::erase(still, ids[k]);
      add_warning(ids[k], reason_of(*steps[k]));
    }
  }
  return still;
}

ScanModel::InGroup ScanModel::placed_among(int id, const std::vector<int>& ids) const {
  const Scan& scan = scans_.at(id);
  InGroup out{{scan.features.surface, scan.group_from_scanner}, {}, {}};
  for (const int other : heard_of(ids, id)) {
    out.others.push_back({scans_.at(other).features.surface, scans_.at(other).group_from_scanner});
  }
  out.fit = judge_in_model(*out.scan.surface, model_scans(out.others), scan.group_from_scanner,
                           options_.search.fit);
  return out;
}

void ScanModel::add_warning(int id, const std::string& said) {
  std::string& warning = scans_.at(id).warning;
  warning += (warning.empty() || said.empty() ? "" : "; ") + said;
}

std::string ScanModel::only_one(const std::vector<int>& ids, int id) const {
  const std::vector<int> others = heard_of(ids, id);
  return others.size() == 1 ? "; or that is wrong with " + name_of(others.front()) +
                                  ", the only one that it was compared with"
                            : "";
}

std::string ScanModel::name_of(int id) const {
  const std::string& file = scans_.at(id).file;
  return file.empty() ? "scan " + std::to_string(id) : file;
}

}  // namespace dubsar
