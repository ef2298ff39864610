// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/poses_scale.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

namespace dubsar {

namespace {

constexpr std::size_t kSamples = 500;  ///< of a scan, at most
/// Cells across the largest scan: as coarse as such samples need to meet, fine enough that two scans which
/// only cross each other share few.
constexpr double kCells = 20;
/// Of the samples that share a cell with another scan, for scans to be together, and how many times fewer it
/// is where their unit is wrong.
constexpr double kTogether = 0.3;
constexpr double kTimesFewer = 1.5;
constexpr double kFarthest = 1e15;  ///< in cells: no number of a file is to go beyond an integer

}  // namespace

void PosesScale::add(const RangeGrid& grid, const RigidTransform& model_from_scanner) {
  const std::size_t valid = grid.valid_count();
  const std::size_t step = std::max<std::size_t>(1, (valid + kSamples - 1) / kSamples);
  One one;
  one.translation_mm = model_from_scanner.translation_mm;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0, seen = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && seen++ % step == 0) {
      one.turned_mm.emplace_back(model_from_scanner.rotation * grid.point(i).cast<double>());
      box.extend(one.turned_mm.back());
    }
  }
  if (!one.turned_mm.empty()) {
    size_mm_ = std::max(size_mm_, box.diagonal().norm());
    scans_.push_back(std::move(one));
  }
}

/// The share of samples in a cell that another scan has samples in, with translations `scale` times as long.
double PosesScale::together(double scale) const {
  using Cell = std::array<std::int64_t, 3>;
  constexpr int kShared = -1;
  std::map<Cell, int> first_in;
  const auto each = [&](const auto& take) {
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      for (const Eigen::Vector3d& turned : scans_[k].turned_mm) {
        const Eigen::Vector3d at = (kCells / size_mm_ * (turned + scale * scans_[k].translation_mm))
                                       .cwiseMax(-kFarthest)
                                       .cwiseMin(kFarthest);
        take(static_cast<int>(k), Cell{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())});
      }
    }
  };
  each([&](int scan, const Cell& cell) {
    const auto [in, is_new] = first_in.try_emplace(cell, scan);
    in->second = is_new || in->second == scan ? scan : kShared;
  });
  std::size_t shared = 0;
  std::size_t all = 0;
  each([&](int, const Cell& cell) {
    shared += first_in.at(cell) == kShared ? 1U : 0U;
    ++all;
  });
  return static_cast<double>(shared) / static_cast<double>(all);
}

std::string PosesScale::fault() const {
  if (scans_.size() < 2 || !(size_mm_ > 0)) {
    return {};
  }
  const double now = together(1);
  for (const double scale : {1000.0, 0.001}) {
    if (const double then = together(scale); then >= kTogether && then > kTimesFewer * now) {
      return std::string("its translations look 1000 times too ") + (scale > 1 ? "small" : "large") +
             " for these scans, which would lie together with that and do not now; say the unit of both, "
             "`\"unit\"` in a poses.json, and --unit or `obj_info unit` of the scans";
    }
  }
  return {};
}

}  // namespace dubsar
