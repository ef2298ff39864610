// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/triangulate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dubsar {

namespace {

// Between nodes a ray is interpolated: with the strongest distortions of lenses used here the error stays
// below 1e-4 px.
constexpr int kNodePx = 8;

}  // namespace

Triangulator::Triangulator(const RigCalibration& calibration, StripeAxis axis)
    : calibration_(calibration), axis_(axis), scanner_from_camera_(calibration.scanner_from_camera()) {
  const CameraModel& camera = calibration_.camera;
  const bool per_column = axis == StripeAxis::kPerColumn;
  samples_ = per_column ? camera.width : camera.height;
  nodes_ = ((per_column ? camera.height : camera.width) + kNodePx - 1) / kNodePx + 1;
  rays_.resize(static_cast<std::size_t>(samples_) * static_cast<std::size_t>(nodes_));
  for (int sample = 0; sample < samples_; ++sample) {
    for (int node = 0; node < nodes_; ++node) {
      const Eigen::Vector2d pixel =
          per_column ? Eigen::Vector2d(sample, node * kNodePx) : Eigen::Vector2d(node * kNodePx, sample);
      // The last node lies beyond the image, where the lens may fold: without distortion it does no harm
      // there.
      rays_[static_cast<std::size_t>(sample) * static_cast<std::size_t>(nodes_) +
            static_cast<std::size_t>(node)] =
          camera.undistort(pixel).value_or(Eigen::Vector2d((pixel.x() - camera.cx_px) / camera.fx_px,
                                                           (pixel.y() - camera.cy_px) / camera.fy_px));
    }
  }
}

Eigen::Vector2d Triangulator::ray(int sample, double along_px) const {
  const double at = std::clamp(along_px / kNodePx, 0.0, nodes_ - 1.001);
  const auto node = static_cast<std::size_t>(at);
  const double t = at - static_cast<double>(node);
  const Eigen::Vector2d* const rays =
      rays_.data() + static_cast<std::size_t>(sample) * static_cast<std::size_t>(nodes_) + node;
  return (1 - t) * rays[0] + t * rays[1];
}

std::optional<Eigen::Vector3d> Triangulator::point_mm(int sample, double along_px, const Plane& plane) const {
  const Eigen::Vector2d n = ray(sample, along_px);
  const Eigen::Vector3d direction(n.x(), n.y(), 1);
  const double slope = plane.normal.dot(direction);
  const double distance = plane.distance_mm / slope;
  if (!(distance > 0) || !std::isfinite(distance)) {
    return std::nullopt;
  }
  return distance * direction;
}

void Triangulator::triangulate(const StripeProfile& stripe, double position, TriangulatedProfile& out) const {
  const auto count = std::min(static_cast<std::size_t>(samples_), stripe.at_px.size());
  for (std::vector<float>* channel : {&out.x, &out.y, &out.z}) {
    channel->assign(static_cast<std::size_t>(samples_), 0.0F);
  }
  out.valid.assign(static_cast<std::size_t>(samples_), 0);
  const RigMotion& motion = calibration_.motion;
  const Plane plane = motion.laser_at(calibration_.laser, position);
  const RigidTransform scanner_from_camera = scanner_from_camera_ * motion.zero_from_camera(position);
  const double half_depth = 0.5 * calibration_.depth_range_mm;
  for (std::size_t i = 0; i < count; ++i) {
    if (stripe.state[i] != StripeState::kGood) {
      continue;
    }
    const auto seen = point_mm(static_cast<int>(i), static_cast<double>(stripe.at_px[i]), plane);
    if (!seen) {
      continue;
    }
    if (half_depth > 0 && std::abs((scanner_from_camera_ * *seen).z()) > half_depth) {
      continue;
    }
    const Eigen::Vector3d p = scanner_from_camera * *seen;
    out.x[i] = static_cast<float>(p.x());
    out.y[i] = static_cast<float>(p.y());
    out.z[i] = static_cast<float>(p.z());
    out.valid[i] = 1;
  }
}

FrameGrid::FrameGrid(const Triangulator& triangulator, double step) : triangulator_(triangulator) {
  grid_.cols = triangulator.samples_per_profile();
  grid_.view = triangulator.calibration().view(step);
  grid_.device = triangulator.calibration().camera_serial;
}

void FrameGrid::append(const StripeProfile& stripe, double position) {
  triangulator_.triangulate(stripe, position, profile_);
  const auto extend = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  extend(grid_.x, profile_.x);
  extend(grid_.y, profile_.y);
  extend(grid_.z, profile_.z);
  extend(grid_.valid, profile_.valid);
  extend(grid_.intensity, stripe.peak);
  extend(grid_.confidence, stripe.confidence);
  ++grid_.rows;
}

RangeGrid FrameGrid::take() {
  grid_.spacing_mm = estimate_spacing_mm(grid_);
  return std::move(grid_);
}

}  // namespace dubsar
