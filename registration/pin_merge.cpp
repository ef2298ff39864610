// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_merge.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace dubsar {

namespace {

struct Cluster {
  SeenPin pin;
  std::map<int, int> labels;  ///< how many measurements carry each
  std::set<int> measured_as;  ///< of those that have a number
  std::set<int> named_as;     ///< likewise, of those with a label
};

/// Whether a measurement has not been counted here.
bool is_new(std::optional<int> measured_as, std::set<int>& counted) {
  return !measured_as || counted.insert(*measured_as).second;
}

void add(Cluster& cluster, const SeenPin& tip, std::optional<int> measured_as) {
  if (tip.label >= 0 && is_new(measured_as, cluster.named_as)) {
    ++cluster.labels[tip.label];
  }
  if (!is_new(measured_as, cluster.measured_as)) {
    return;
  }
  const double before = cluster.pin.placements;
  const double after = before + 1;
  cluster.pin.position_mm = (before * cluster.pin.position_mm + tip.position_mm) / after;
  cluster.pin.covariance_mm2 =
      (before * before * cluster.pin.covariance_mm2 + tip.covariance_mm2) / (after * after);
  cluster.pin.placements += 1;
}

}  // namespace

std::vector<SeenPin> merged_pins(std::span<const PlacedPins> scans, double reach_mm) {
  std::vector<Cluster> clusters;
  for (const PlacedPins& scan : scans) {
    const Eigen::Matrix3d r = scan.model_from_scanner.rotation;
    std::vector<SeenPin> tips = scan.tips;
    std::vector<std::tuple<double, std::size_t, std::size_t>> near;  // distance, tip, cluster
    for (std::size_t k = 0; k < tips.size(); ++k) {
      tips[k].position_mm = scan.model_from_scanner * tips[k].position_mm;
      tips[k].covariance_mm2 = r * tips[k].covariance_mm2 * r.transpose();
      for (std::size_t c = 0; c < clusters.size(); ++c) {
        const double off = (clusters[c].pin.position_mm - tips[k].position_mm).norm();
        if (off <= reach_mm) {
          near.emplace_back(off, k, c);
        }
      }
    }
    std::sort(near.begin(), near.end());
    std::vector<bool> placed(tips.size(), false);
    std::vector<bool> taken(clusters.size(), false);
    for (const auto& [off, k, c] : near) {
      if (!placed[k] && !taken[c]) {
        placed[k] = taken[c] = true;
        add(clusters[c], tips[k], scan.measured_as);
      }
    }
    for (std::size_t k = 0; k < tips.size(); ++k) {
      if (!placed[k]) {
        Cluster cluster;
        cluster.pin.placements = 0;
        add(cluster, tips[k], scan.measured_as);
        clusters.push_back(std::move(cluster));
      }
    }
  }
  std::vector<SeenPin> out;
  for (Cluster& cluster : clusters) {
    const auto most = std::max_element(cluster.labels.begin(), cluster.labels.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    cluster.pin.label = most == cluster.labels.end() ? -1 : most->first;
    out.push_back(cluster.pin);
  }
  return out;
}

}  // namespace dubsar
