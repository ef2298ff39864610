// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What hands hide and what they hold: poses that only they speak against.
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "registration/foreign_matter.h"
#include "registration/scan_motion.h"
#include "registration/without_foreign.h"

namespace dubsar {

namespace {

/// Of the cells of a scan that can be matched, no more than this may be left out: hands take up to 0.38 on
/// simulated tablets of 60 mm.
constexpr double kMostLeftOut = 0.5;
/// What may speak against the rest (doubt()): no more than against a pose that no relief settles. Right poses
/// show 0.1 to 0.5 there.
constexpr double kMostDoubt = 1.0;
/// A pose that was found is not off by more; what moves farther is another.
constexpr double kMostTurnRad = 0.02;
constexpr double kMostSpacings = 3.0;

/// As ForeignMatter takes them: what cannot be matched is not surely sampled.
SampleFlags flags_of(const SurfaceLevel& level) {
  SampleFlags flags(level.grid.size(), 0);
  std::ranges::transform(level.usable, flags.begin(), [](std::uint8_t usable) {
    return usable == 0 ? std::uint8_t{kPotentiallySparse} : std::uint8_t{0};
  });
  return flags;
}

}  // namespace

const ScanSurface& ScanModel::whole_of(int id) const {
  const Scan& scan = scans_.at(id);
  return scan.whole ? *scan.whole : *scan.features.surface;
}

void ScanModel::make_whole(int id) {
  Scan& scan = scans_.at(id);
  if (scan.whole) {
    scan.features = make_scan_features(std::exchange(scan.whole, nullptr), options_.search.align);
    scan.left_out.clear();
  }
}

ScanModel::WithoutForeign::WithoutForeign(ScanModel& model, int id, std::vector<int> ids)
    : model_(model), id_(id), ids_(std::move(ids)) {}

ScanModel::WithoutForeign::~WithoutForeign() {
  put_back();
}

std::vector<ModelScan> ScanModel::WithoutForeign::whole_model() const {
  std::vector<ModelScan> out;
  out.reserve(ids_.size());
  for (const int id : ids_) {
    out.push_back({&model_.whole_of(id), model_.scans_.at(id).group_from_scanner});
  }
  return out;
}

const ModelFit* ScanModel::WithoutForeign::candidate(const FoundPose& found) const {
  const VerifyOptions& verify = model_.options_.search.verify;
  const auto best = std::ranges::max_element(found.fits, {}, &ModelFit::significance);
  if (best == found.fits.end() || !sure(*best, verify) ||
      best->significance < model_.options_.search.enough_significance) {
    return nullptr;
  }
  const auto is_rival = [&](const ModelFit& fit) {
    return &fit != &*best && fit.significance >= verify.rival_relief * best->significance;
  };
  return std::ranges::any_of(found.fits, is_rival) ? nullptr : &*best;
}

std::optional<std::map<int, ScanModel::WithoutForeign::Marks>> ScanModel::WithoutForeign::foreign_at(
    const RigidTransform& group_from_scanner) const {
  std::vector<ScanPose> poses;
  ForeignMatter matter;
  const auto place = [&](int id, const RigidTransform& pose) {
    const SurfaceLevel& fine = *model_.whole_of(id).fine;
    matter.add(id, fine.grid, flags_of(fine));
    poses.emplace_back();
    poses.back().id = id;
    poses.back().status = PoseStatus::kRegistered;
    poses.back().model_from_scanner = pose;
  };
  for (const int id : ids_) {
    place(id, model_.scans_.at(id).group_from_scanner);
  }
  const Scan& scan = model_.scans_.at(id_);
  const RigidTransform group_from_own = group_from_scanner * scan.group_from_scanner.inverse();
  for (const int id : model_.members(scan.group)) {
    place(id, group_from_own * model_.scans_.at(id).group_from_scanner);
  }
  std::map<int, Marks> out;
  for (const ForeignFound& found : matter.find(poses)) {
    const SurfaceLevel& fine = *model_.whole_of(found.id).fine;
    const std::vector<Matter> what = matter.matter(found.id, fine.grid);
    Marks& marks = out[found.id];
    marks.resize(what.size());
    std::ranges::transform(what, marks.begin(), [](Matter m) {
      return m == Matter::kForeign ? std::uint8_t{1} : std::uint8_t{0};
    });
    const auto usable = static_cast<double>(std::ranges::count(fine.usable, std::uint8_t{1}));
    const int lost = std::transform_reduce(marks.begin(), marks.end(), fine.usable.begin(), 0, std::plus{},
                                           [](std::uint8_t mark, std::uint8_t use) { return mark & use; });
    if (lost > kMostLeftOut * usable) {
      return std::nullopt;
    }
    if (lost == 0) {
      out.erase(found.id);
    }
  }
  for (const ScanCopy& copy : matter.copies()) {  // what shows in a scan shows in its copy, cell by cell
    const RangeGrid& grid = model_.whole_of(copy.id).fine->grid;
    const RangeGrid& of = model_.whole_of(copy.of_id).fine->grid;
    if (const auto first = out.find(copy.of_id);
        first != out.end() && grid.rows == of.rows && grid.cols == of.cols && grid.valid == of.valid) {
      out[copy.id] = first->second;
    }
  }
  return out.empty() ? std::nullopt : std::optional(std::move(out));
}

void ScanModel::WithoutForeign::leave_out(std::map<int, Marks> marks) {
  for (auto& [id, of_scan] : marks) {
    Scan& scan = model_.scans_.at(id);
    if (scan.left_out == of_scan) {
      continue;
    }
    before_.try_emplace(id, scan.features, scan.left_out);
    if (!scan.whole) {
      scan.whole = scan.features.surface;
    }
    scan.features.surface = without(*scan.whole, of_scan, model_.options_.surface);
    scan.left_out = std::move(of_scan);
  }
}

void ScanModel::WithoutForeign::put_back() {
  for (auto& [id, was] : before_) {
    Scan& scan = model_.scans_.at(id);
    std::tie(scan.features, scan.left_out) = std::move(was);
    if (scan.left_out.empty()) {
      scan.whole.reset();
    }
  }
  before_.clear();
}

void ScanModel::WithoutForeign::keep() {
  for (const auto& [id, was] : before_) {
    Scan& scan = model_.scans_.at(id);
    scan.features = make_scan_features(scan.features.surface, model_.options_.search.align);
  }
  before_.clear();
}

bool ScanModel::WithoutForeign::settles(FoundPose& found) {
  const ModelFit* const refused = candidate(found);
  if (refused == nullptr) {
    return false;
  }
  const PoseSearchOptions& options = model_.options_.search;
  const RigidTransform pose = refused->model_from_scanner;
  const Eigen::Vector3d middle_mm = whole().centroid_mm;
  const double most_mm = kMostSpacings * whole().fine->spacing_mm;
  const auto is_that = [&](const RigidTransform& other) {
    return same_pose(pose, other, middle_mm, kMostTurnRad, most_mm);
  };
  if (std::ranges::any_of(looked_at_, is_that)) {
    return false;
  }
  looked_at_.push_back(pose);
  std::optional<std::map<int, Marks>> marks = foreign_at(pose);
  if (!marks) {
    return false;
  }
  const std::vector<ModelScan> others = whole_model();
  if (find_motion(whole(), others, judge_in_model(whole(), others, pose, options.fit), options.fit)) {
    return false;
  }
  const bool told = refused->told;
  leave_out(std::move(*marks));
  ModelFitOptions close = options.fit;
  close.starts_are_close = true;
  std::vector<ModelFit> fits =
      fit_to_model(*model_.scans_.at(id_).features.surface, model_.model_of(ids_), {&pose, 1}, close);
  for (ModelFit& fit : fits) {
    fit.told = told;
  }
  const PoseVerdict verdict = verify_pose(fits, options.verify);
  if (verdict.status != PoseStatus::kRegistered || !sure(fits.front(), options.verify) ||
      fits.front().significance < options.enough_significance ||
      doubt(fits.front(), options.verify) > kMostDoubt || !is_that(fits.front().model_from_scanner)) {
    put_back();
    return false;
  }
  found = {std::move(fits), verdict, false};
  return true;
}

}  // namespace dubsar
