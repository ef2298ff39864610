// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/ball_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::size_t kRings = 3;
constexpr std::size_t kSectors = kFaceParts / kRings;
constexpr double kSeen = 0.25;  // of an even share

/// Of the angle to the view, at the outer edge of as many rings: on a sphere areas go by it.
double cosine_after(std::size_t rings) {
  const double share = static_cast<double>(rings) / static_cast<double>(kRings);
  return 1 - share * (1 - std::cos(rad_from_deg(kFaceDeg)));
}

}  // namespace

bool before_face(const Eigen::Vector3d& point_mm, const Sphere& ball, const Eigen::Vector3d& towards) {
  return (point_mm - ball.center_mm).normalized().dot(towards) >= std::cos(rad_from_deg(kFaceDeg));
}

std::size_t seen_parts(const std::vector<Eigen::Vector3d>& on_face_mm, const Sphere& ball,
                       const Eigen::Vector3d& towards) {
  const Eigen::Vector3d across = towards.unitOrthogonal();
  const Eigen::Vector3d along = towards.cross(across);
  std::array<std::size_t, kFaceParts> counts{};
  for (const Eigen::Vector3d& p : on_face_mm) {
    const Eigen::Vector3d arm = (p - ball.center_mm).normalized();
    std::size_t ring = 0;
    while (ring + 1 < kRings && arm.dot(towards) < cosine_after(ring + 1)) {
      ++ring;
    }
    const double turn = 0.5 + std::atan2(arm.dot(along), arm.dot(across)) / (2 * std::numbers::pi);
    const auto sector = std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors));
    ++counts[ring * kSectors + sector];
  }
  // As the scanner sees it, an area goes by the square of the sine.
  const auto seen_area = [](std::size_t rings) { return 1 - cosine_after(rings) * cosine_after(rings); };
  std::size_t seen = 0;
  for (std::size_t part = 0; part < kFaceParts; ++part) {
    const std::size_t ring = part / kSectors;
    const double share =
        (seen_area(ring + 1) - seen_area(ring)) / (seen_area(kRings) * static_cast<double>(kSectors));
    seen +=
        static_cast<double>(counts[part]) >= kSeen * share * static_cast<double>(on_face_mm.size()) ? 1 : 0;
  }
  return on_face_mm.empty() ? 0 : seen;
}

}  // namespace dubsar
