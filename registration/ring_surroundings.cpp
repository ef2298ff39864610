// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/ring_surroundings.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar {

namespace {

/// A cell that holds no sample takes what lies between those within so many spacings of its middle: cells
/// are narrower than the spacing of coarse scans, and a narrow gap leaves some empty.
constexpr float kBetween = 1.1F;

Eigen::Vector2f middle_of(std::size_t cell, float radius_mm) {
  const auto ring = static_cast<int>(cell) / RingSurroundings::kSectors;
  const auto sector = static_cast<int>(cell) % RingSurroundings::kSectors;
  const auto rho =
      radius_mm * (static_cast<float>(ring) + 0.5F) / static_cast<float>(RingSurroundings::kRings);
  const auto turn = static_cast<float>(2 * kPi * (sector + 0.5) / RingSurroundings::kSectors - kPi);
  return {rho * std::cos(turn), rho * std::sin(turn)};
}

}  // namespace

void RingSurroundings::look(const SurfaceLevel& level, const RingFrame& frame, float radius_mm) {
  radius_mm_ = radius_mm;
  reach_mm_ = kBetween * static_cast<float>(level.spacing_mm);
  places_.clear();
  beside_.clear();
  known_.fill({});
  level.lookup->for_each_near(frame.origin, radius_mm, [&](std::size_t i) {
    const Eigen::Vector3f d = level.grid.point(i) - frame.origin;
    const float h = d.dot(frame.normal);
    const Eigen::Vector2f at(d.dot(frame.u), d.dot(frame.v));
    const float rho = at.norm();
    if (rho >= radius_mm || std::abs(h) > radius_mm) {
      return;
    }
    const int ring = std::min(static_cast<int>(rho / radius_mm * kRings), kRings - 1);
    const float turn = (std::atan2(at.y(), at.x()) + static_cast<float>(kPi)) / static_cast<float>(2 * kPi);
    const int sector = std::min(static_cast<int>(turn * kSectors), kSectors - 1);
    places_.push_back({i, static_cast<std::size_t>(ring * kSectors + sector), at, h});
  });
}

std::span<const RingSurroundings::Beside> RingSurroundings::beside(std::size_t cell) {
  Known& known = known_[cell];
  if (!known.is) {
    known = {true, beside_.size(), 0};
    const Eigen::Vector2f middle = middle_of(cell, radius_mm_);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const Eigen::Vector2f d = middle - places_[k].at;
      const float w = 1.0F - d.squaredNorm() / (reach_mm_ * reach_mm_);
      if (w > 0) {
        beside_.push_back({k, d, w});
      }
    }
    known.end = beside_.size();
  }
  return std::span(beside_).subspan(known.begin, known.end - known.begin);
}

}  // namespace dubsar
