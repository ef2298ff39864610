// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Parts of scans that came as scans of their own. A part may find its place where the whole does not (a hand
// was cut off), so it is searched like any other; beside the whole it says nothing that this one does not.
#include <algorithm>
#include <iterator>

#include "registration/relaxation_covariance.h"
#include "registration/scan_model.h"

namespace dubsar {

void ScanModel::find_parts(int id) {
  const std::optional<ScanPrint>& print = scans_.at(id).print;
  for (const auto& [other, scan] : scans_) {
    if (other == id || !print || !scan.print) {
      continue;
    }
    const bool other_is_part = is_part(*scan.print, *print);
    if (!other_is_part && !is_part(*print, *scan.print)) {
      continue;
    }
    const auto [part, whole] = other_is_part ? std::pair(other, id) : std::pair(id, other);
    if (const auto motion = copy_motion(*scans_.at(whole).print, *scans_.at(part).print)) {
      parts_[{part, whole}] = *motion;
    }
  }
}

std::optional<int> ScanModel::whole_among(const std::vector<int>& ids, int id) const {
  if (scans_.at(id).is_locked()) {
    return std::nullopt;
  }
  for (auto at = parts_.lower_bound({id, 0}); at != parts_.end() && at->first.first == id; ++at) {
    if (std::ranges::binary_search(ids, at->first.second)) {
      return at->first.second;
    }
  }
  return std::nullopt;
}

int ScanModel::measured_as(const std::vector<int>& ids, int id) const {
  // A whole has more samples than its part, so this ends.
  for (std::optional<int> whole = whole_among(ids, id); whole; whole = whole_among(ids, id)) {
    id = *whole;
  }
  return id;
}

std::size_t ScanModel::measurements(const std::vector<int>& ids) const {
  return ids.size() - static_cast<std::size_t>(std::ranges::count_if(
                          ids, [&](int id) { return whole_among(ids, id).has_value(); }));
}

std::vector<int> ScanModel::heard_of(const std::vector<int>& ids, int id) const {
  std::vector<int> out;
  std::ranges::copy_if(ids, std::back_inserter(out), [&](int other) {
    return other != id && !whole_among(ids, other) && !parts_.contains({id, other}) &&
           !parts_.contains({other, id});
  });
  return out;
}

void ScanModel::place_parts(const std::vector<int>& ids) {
  // Wholes first, which may be parts of others.
  std::vector<std::pair<int, int>> part_of;
  for (const int id : ids) {
    if (const auto whole = whole_among(ids, id)) {
      part_of.emplace_back(id, *whole);
    }
  }
  std::ranges::stable_sort(part_of, std::ranges::greater{}, [&](const std::pair<int, int>& entry) {
    return scans_.at(entry.first).print->samples;
  });
  for (const auto& [id, whole_id] : part_of) {
    Scan& part = scans_.at(id);
    const Scan& whole = scans_.at(whole_id);
    part.group_from_scanner = (whole.group_from_scanner * parts_.at({id, whole_id})).orthonormalised();
    // The same twist, said about another place.
    const Eigen::Vector3d from = whole.group_from_scanner * whole.features.surface->centroid_mm;
    const Eigen::Vector3d to = part.group_from_scanner * part.features.surface->centroid_mm;
    part.covariance = about_place(whole.covariance, to - from);
  }
}

}  // namespace dubsar
