// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/press_index.h"

namespace dubsar::sim {

namespace {
constexpr double kCellMm = 1.5;
}

PressIndex::PressIndex(const std::vector<Impression>& impressions, const Eigen::Vector3d& half_size_mm)
    : low_(-half_size_mm - Eigen::Vector3d::Constant(2.0 * kCellMm)) {
  cells_ = ((-2.0 * low_) / kCellMm).array().ceil().cast<int>().max(1).matrix();
  start_.assign(bucket(cells_ - Eigen::Vector3i::Ones()) + 2, 0);
  const auto for_each_bucket = [&](const Impression& impression, const auto& visit) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(impression.reach_mm());
    const Eigen::Vector3i first = cell_of(impression.centre_mm() - reach);
    const Eigen::Vector3i last = cell_of(impression.centre_mm() + reach);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          visit(bucket({x, y, z}));
        }
      }
    }
  };
  for (const Impression& impression : impressions) {
    for_each_bucket(impression, [&](std::size_t b) { ++start_[b + 1]; });
  }
  for (std::size_t b = 1; b < start_.size(); ++b) {
    start_[b] += start_[b - 1];
  }
  entries_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t i = 0; i < impressions.size(); ++i) {
    for_each_bucket(impressions[i], [&](std::size_t b) { entries_[next[b]++] = i; });
  }
}

Eigen::Vector3i PressIndex::cell_of(const Eigen::Vector3d& p_mm) const {
  const Eigen::Vector3i cell = ((p_mm - low_) / kCellMm).array().floor().cast<int>().matrix();
  return cell.cwiseMax(0).cwiseMin(cells_ - Eigen::Vector3i::Ones());
}

std::size_t PressIndex::bucket(const Eigen::Vector3i& cell) const {
  return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(cells_.y()) +
          static_cast<std::size_t>(cell.y())) *
             static_cast<std::size_t>(cells_.x()) +
         static_cast<std::size_t>(cell.x());
}

std::span<const std::uint32_t> PressIndex::near(const Eigen::Vector3d& p_mm) const {
  const std::size_t b = bucket(cell_of(p_mm));
  return {entries_.data() + start_[b], entries_.data() + start_[b + 1]};
}

}  // namespace dubsar::sim
