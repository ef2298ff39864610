// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_contradiction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>

#include "core/number_text.h"

namespace dubsar {

namespace {

/// A tip with a label, in the model.
struct Place {
  std::size_t scan = 0;
  Eigen::Vector3d at_mm{0, 0, 0};
  double variance_mm2 = 0;  ///< per axis, as measured
  bool votes = true;        ///< false: the scan that this one is a part of shows the label, too
};

double off_mm(const Place& a, const Place& b) {
  return (a.at_mm - b.at_mm).norm();
}

/// Within what putting a pin back and clicking at it make of one place.
bool agree(const Place& a, const Place& b, const PinAdviceOptions& options) {
  const double variance =
      2.0 * options.replaced_sigma_mm * options.replaced_sigma_mm + a.variance_mm2 + b.variance_mm2;
  return off_mm(a, b) <= std::max(options.too_close_mm, 5.0 * std::sqrt(variance));
}

/// The one that most others agree with; of equals the first.
const Place& likeliest(const std::vector<Place>& places, const PinAdviceOptions& options) {
  return *std::ranges::max_element(places, {}, [&](const Place& place) {
    return std::ranges::count_if(places, [&](const Place& other) {
      return place.votes && other.votes && agree(place, other, options);
    });
  });
}

}  // namespace

std::string moved_pin(const std::string& pin, int other_id, double off_mm) {
  return pin + " has moved: scan " + std::to_string(other_id) + " shows it " + fixed_text(off_mm, 1) +
         " mm away; put it back, or correct its label";
}

std::vector<std::string> contradicted_labels(std::span<const ScanPinsInModel> scans,
                                             const PinAdviceOptions& options) {
  std::map<int, std::vector<Place>> by_label;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    for (const SeenPin& tip : scans[k].tips) {
      if (tip.label >= 0) {
        by_label[tip.label].push_back(
            {k, scans[k].model_from_scanner * tip.position_mm, tip.covariance_mm2.trace() / 3.0, true});
      }
    }
  }
  std::vector<std::string> said(scans.size());
  std::vector<double> farthest_mm(scans.size(), 0.0);
  for (auto& [label, places] : by_label) {
    for (Place& place : places) {
      const std::optional<int> whole = scans[place.scan].part_of;
      place.votes = !whole || std::ranges::none_of(
                                  places, [&](const Place& other) { return scans[other.scan].id == *whole; });
    }
    const Place& right = likeliest(places, options);
    for (const Place& place : places) {
      const double off = off_mm(place, right);
      if (!agree(place, right, options) && off > farthest_mm[place.scan]) {
        farthest_mm[place.scan] = off;
        said[place.scan] = moved_pin("pin " + std::to_string(label), scans[right.scan].id, off);
      }
    }
  }
  return said;
}

}  // namespace dubsar
