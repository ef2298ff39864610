// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/same_places.h"

#include <algorithm>
#include <limits>

namespace dubsar {

namespace {

/// A product of two transforms rounds a number by up to 3 ε, one with another frame and its inverse by 6, and
/// that frame is a rotation to within some ε itself.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
/// How far the origins of frames are from each other: a shift rounds as the largest that it comes from.
constexpr double kFarMm = 1000.0;

}  // namespace

bool is_same_place(const RigidTransform& a, const RigidTransform& b) {
  const double far_mm = std::max({kFarMm, a.translation_mm.norm(), b.translation_mm.norm()});
  return ((a.rotation - b.rotation).array().abs() <= kRounding).all() &&
         ((a.translation_mm - b.translation_mm).array().abs() <= kRounding * far_mm).all();
}

std::vector<ScanPose> as_shown(std::vector<ScanPose> poses, const std::vector<ScanPose>& shown) {
  for (ScanPose& pose : poses) {
    const auto there = std::ranges::find(shown, pose.id, &ScanPose::id);
    if (there != shown.end() && is_same_place(pose.model_from_scanner, there->model_from_scanner)) {
      pose.model_from_scanner = there->model_from_scanner;
    }
  }
  return poses;
}

}  // namespace dubsar
