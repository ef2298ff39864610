// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/places_in_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace dubsar {

namespace {

/// A tablet that fills more of the field than this reaches its border where a hand has laid it a little off.
constexpr double kFills = 0.9;
/// Of the field, what one place is counted on for: tilted views see less of it, and a hand lays it a little
/// off.
constexpr double kCountedOn = 0.7;
/// Of a tablet 60 times as long as the field no more is planned.
constexpr int kMostAlong = 16;

/// The tablet along one of its axes, as far as it is known.
struct Extent {
  Face low = Face::kLeft;  ///< which way its negative end looks
  Face high = Face::kRight;
  Eigen::Vector3d axis{1, 0, 0};  ///< model frame
  double length_mm = 0;
  double upright = 0;  ///< 1 where it stands along the vertical, 0 where it lies
};

/// Where along an axis the field has to lie, from the middle; the middle alone where that is enough.
std::vector<double> steps_along(double length_mm, double field_mm) {
  if (length_mm <= kFills * field_mm) {
    return {0.0};
  }
  const double counted_mm = kCountedOn * field_mm;
  const int count = std::clamp(static_cast<int>(std::ceil(length_mm / counted_mm)), 2, kMostAlong);
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    out.push_back((length_mm - counted_mm) * (static_cast<double>(k) / (count - 1) - 0.5));
  }
  return out;
}

std::string towards(const Extent& extent, double step_mm) {
  return std::abs(step_mm) < 0.5
             ? std::string()
             : std::to_string(std::lround(std::abs(step_mm))) + " mm from its middle towards " +
                   spoken(step_mm < 0 ? extent.low : extent.high);
}

}  // namespace

std::vector<PlaceInField> places_in_field(const Rig& rig, const Eigen::Matrix3d& stage_from_model,
                                          const ModelSurface& surface) {
  std::array<Extent, 3> extents = {Extent{Face::kLeft, Face::kRight}, Extent{Face::kBottom, Face::kTop},
                                   Extent{Face::kReverse, Face::kObverse}};
  for (Extent& extent : extents) {
    extent.axis = surface.faces.normal(extent.high);
    double low = 0;
    double high = 0;
    for (const Eigen::Vector3d& corner : surface.corners_mm) {
      const double at = extent.axis.dot(corner - surface.center_mm);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    extent.length_mm = high - low;
    extent.upright = std::abs(stage_from_model.row(2).dot(extent.axis.transpose()));
  }
  std::ranges::stable_sort(extents, {}, &Extent::upright);
  const double field_mm = std::min(rig.field_x_mm, rig.field_y_mm);
  const std::vector<double> along = steps_along(extents[0].length_mm, field_mm);
  const std::vector<double> across = steps_along(extents[1].length_mm, field_mm);
  std::vector<PlaceInField> out;
  if (along.size() * across.size() == 1) {
    return out;
  }
  out.push_back({Eigen::Vector3d::Zero(), "lay its middle under the scanner"});
  for (const double a : along) {
    for (const double b : across) {
      const std::string first = towards(extents[0], a);
      const std::string second = towards(extents[1], b);
      if (first.empty() && second.empty()) {
        continue;
      }
      PlaceInField& place = out.emplace_back();
      place.offset_mm = a * extents[0].axis + b * extents[1].axis;
      place.say = "lay the place " + first;
      place.say += (first.empty() || second.empty() ? "" : ", ") + second;
      place.say += " under the scanner";
    }
  }
  return out;
}

std::vector<HeightInField> heights_in_field(const Rig& rig, const Eigen::Matrix3d& stage_from_model,
                                            const ModelSurface& surface) {
  const Eigen::Vector3d up = stage_from_model.row(2).transpose();
  double top_mm = 0;
  for (const Eigen::Vector3d& corner : surface.corners_mm) {
    top_mm = std::max(top_mm, up.dot(corner - surface.center_mm));
  }
  std::vector<HeightInField> out;
  if (top_mm <= 0.5 * kFills * rig.depth_range_mm) {
    return out;
  }
  const double counted_mm = kCountedOn * rig.depth_range_mm;
  const double highest_mm = top_mm - 0.5 * counted_mm;
  const int count = std::clamp(static_cast<int>(std::ceil(highest_mm / counted_mm)), 1, kMostAlong);
  out.push_back({0, "bring its middle to the working distance"});
  for (int k = 1; k <= count; ++k) {
    const double above_mm = highest_mm * k / count;
    out.push_back({above_mm, "bring the place " + std::to_string(std::lround(above_mm)) +
                                 " mm above its middle to the working distance"});
  }
  return out;
}

}  // namespace dubsar
