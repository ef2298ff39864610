// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/camera_region.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/setting_words.h"

namespace dubsar {

namespace {

/// It has to have its size before it can go from the corner, and its size may be what keeps it there.
Status put_at_corner(Device& camera, const std::string& where) {
  return put_settings(camera, {{"offset_x_px", "0"}, {"offset_y_px", "0"}}, where);
}

/// Height of the clay, scanner frame, that the camera sees lit at an image point; at stage position 0.
std::optional<double> height_at(const RigCalibration& rig, const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector2d> ray = rig.camera.undistort(pixel);
  if (!ray) {
    return std::nullopt;
  }
  const Eigen::Vector3d direction(ray->x(), ray->y(), 1);
  const std::optional<double> reach = rig.laser.along(Eigen::Vector3d::Zero(), direction);
  return reach && *reach > 0
             ? std::optional((rig.scanner_from_camera() * Eigen::Vector3d(*reach * direction)).z())
             : std::nullopt;
}

/// Where the camera sees the origin of the scanner frame.
Eigen::Vector2d middle_of(const CameraModel& camera) {
  return camera.distort(Eigen::Vector2d::Zero());
}

}  // namespace

Result<RigCalibration> seen_in(const PictureRegion& region, const RigCalibration& calibration,
                               const std::string& where) {
  const CameraModel& whole = calibration.camera;
  if (region.x + region.width > whole.width || region.y + region.height > whole.height) {
    return bad_input(where, "region_px reaches beyond the picture that was calibrated",
                     "which has " + std::to_string(whole.width) + " x " + std::to_string(whole.height) +
                         " pixels: calibrate with the whole picture, and scan with a part of that");
  }
  RigCalibration out = calibration;
  CameraModel& part = out.camera;
  part.width = region.width;
  part.height = region.height;
  part.cx_px -= region.x;
  part.cy_px -= region.y;
  const Eigen::Vector2d middle = middle_of(part);
  if (!part.sees(middle)) {
    return bad_input(where, "region_px leaves out the middle of the measuring volume",
                     "which the camera sees at pixel " + std::to_string(std::lround(middle.x() + region.x)) +
                         ", " + std::to_string(std::lround(middle.y() + region.y)));
  }
  return out;
}

double depth_mm(const RigCalibration& calibration) {
  const CameraModel& camera = calibration.camera;
  const Eigen::Vector2d middle = middle_of(camera);
  // To the nearer end of the way on which depth moves the stripe.
  const Eigen::Vector2d along =
      camera.project(calibration.scanner_from_camera().inverse() * Eigen::Vector3d(0, 0, 0.5)) - middle;
  const bool down = std::abs(along.y()) > std::abs(along.x());
  double half_mm = 0.5 * calibration.depth_range_mm;
  for (const double end : {-0.5, (down ? camera.height : camera.width) - 0.5}) {
    const Eigen::Vector2d pixel = down ? Eigen::Vector2d(middle.x(), end) : Eigen::Vector2d(end, middle.y());
    if (const std::optional<double> height = height_at(calibration, pixel)) {
      half_mm = std::min(half_mm, std::abs(*height));
    }
  }
  return 2 * half_mm;
}

double field_mm(const RigCalibration& calibration, bool stripe_per_row) {
  const CameraModel& camera = calibration.camera;
  const double size = stripe_per_row ? camera.height : camera.width;
  const double middle = stripe_per_row ? camera.cy_px : camera.cx_px;
  return 2 * std::min(middle + 0.5, size - 0.5 - middle) * calibration.field_per_px_mm();
}

Status put_region(const PictureRegion& region, Device& camera, const std::string& where) {
  const auto words = [](int number) { return std::to_string(number); };
  Status put = put_at_corner(camera, where);
  return put ? put_settings(camera,
                            {{"width_px", words(region.width)},
                             {"height_px", words(region.height)},
                             {"offset_x_px", words(region.x)},
                             {"offset_y_px", words(region.y)}},
                            where)
             : put;
}

Status put_whole_picture(Device& camera, const std::string& where) {
  if (Status put = put_at_corner(camera, where); !put) {
    return put;
  }
  const Result<std::vector<SettingInfo>> settings = camera.settings();
  if (!settings) {
    return std::unexpected(settings.error());
  }
  std::vector<std::pair<std::string, std::string>> all;
  for (const SettingInfo& setting : *settings) {
    if ((setting.key == "width_px" || setting.key == "height_px") && setting.range) {
      all.emplace_back(setting.key, std::to_string(std::llround(setting.range->second)));
    }
  }
  return put_settings(camera, all, where);
}

}  // namespace dubsar
