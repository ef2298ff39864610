// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/vain_look.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/units.h"

namespace dubsar {

namespace {

const double kApartCosine = std::cos(rad_from_deg(15.0));
/// Views closer than this see the same shadows.
const double kSameSideRad = rad_from_deg(25.0);
/// What is left of a place's worth after one look in vain from the same side, and from any side.
constexpr double kLeftSameSide = 0.15;
constexpr double kLeftAnySide = 0.8;

bool stand_apart(const VainLook& a, const VainLook& b) {
  return a.towards_scanner.dot(b.towards_scanner) < kApartCosine ||
         a.towards_camera.dot(b.towards_camera) < kApartCosine;
}

}  // namespace

std::size_t full_looks_apart(std::span<const VainLook> looks) {
  std::vector<const VainLook*> counted;
  for (const VainLook& look : looks) {
    if (look.chance > kTriedChance &&
        std::ranges::all_of(counted, [&](const VainLook* other) { return stand_apart(look, *other); })) {
      counted.push_back(&look);
    }
  }
  return counted.size();
}

double looks_worth(std::span<const VainLook> looks) {
  double sum = 0;
  for (const VainLook& look : looks) {
    sum += std::min(1.0, look.chance / kTriedChance);
  }
  return sum;
}

double novelty(std::span<const VainLook> looks, const Eigen::Vector3d& towards_scanner) {
  double left = 1.0;
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const VainLook& look = looks[k];
    const bool stood_there_before =
        std::ranges::any_of(looks.first(k), [&](const VainLook& other) { return !stand_apart(look, other); });
    const double apart =
        std::acos(std::clamp(look.towards_scanner.dot(towards_scanner), -1.0, 1.0)) / kSameSideRad;
    const double full =
        (stood_there_before ? 1.0 : kLeftAnySide) * (1.0 - (1.0 - kLeftSameSide) * std::exp(-apart * apart));
    left *= std::pow(full, std::min(1.0, look.chance / kTriedChance));
  }
  return left;
}

}  // namespace dubsar
