// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/real_table.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

constexpr std::size_t kMarkers = 4;

/// Corners without the lens's distortion: x/z and y/z.
std::vector<cv::Point2f> straightened(const std::vector<cv::Point2f>& corners_px, const CameraModel& camera) {
  std::vector<cv::Point2f> out;
  for (const cv::Point2f& p : corners_px) {
    const auto ray = camera.undistort({static_cast<double>(p.x), static_cast<double>(p.y)});
    if (ray) {
      out.emplace_back(static_cast<float>(ray->x()), static_cast<float>(ray->y()));
    }
  }
  return out;
}

RigidTransform pose(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Mat matrix;
  cv::Rodrigues(rotation, matrix);
  RigidTransform out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      out.rotation(r, c) = matrix.at<double>(r, c);
    }
    out.translation_mm[r] = translation.at<double>(r);
  }
  return out;
}

/// A marker as the table carries it: where its middle lies in units of the circle's radius, and its turn.
struct Placed {
  Eigen::Vector2d at{0, 0};
  double turn_rad = 0;
};

std::array<cv::Point3f, 4> corners_mm(const Placed& placed, double circle_mm, double marker_mm) {
  std::array<cv::Point3f, 4> out;
  const Eigen::Rotation2Dd turn(placed.turn_rad);
  const double h = marker_mm / 2;
  const std::array<Eigen::Vector2d, 4> own{Eigen::Vector2d(-h, h), {h, h}, {h, -h}, {-h, -h}};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Eigen::Vector2d p = circle_mm * placed.at + turn * own[k];
    out[k] = {static_cast<float>(p.x()), static_cast<float>(p.y()), 0};
  }
  return out;
}

}  // namespace

Intrinsics seen_by(const CameraModel& camera, const std::vector<CalibrationView>& views) {
  Intrinsics out;
  out.camera = camera;
  for (std::size_t k = 0; k < views.size(); ++k) {
    std::vector<cv::Point2f> seen;
    for (const Eigen::Vector2d& p : views[k].board.corners_px) {
      seen.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
    const std::vector<cv::Point2f> straight = straightened(seen, camera);
    if (straight.size() != seen.size()) {
      continue;  // beyond where the lens model ends
    }
    std::vector<cv::Point3f> corners;
    for (const Eigen::Vector3d& p : views[k].board.corners_mm) {
      corners.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    }
    cv::Mat rotation;
    cv::Mat translation;
    cv::solvePnP(corners, straight, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotation, translation);
    out.used.push_back(k);
    out.camera_from_board.push_back(pose(rotation, translation));
  }
  return out;
}

Result<MarkedTable> find_marked_table(const GrayImage& image, const CameraModel& camera, double marker_mm) {
  const cv::Mat picture(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> found;
  const auto how = cv::aruco::DetectorParameters::create();
  how->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50), found, ids,
                           how);
  if (found.size() != kMarkers) {
    return bad_input({}, std::to_string(found.size()) + " markers are seen, not four",
                     "give a photograph of the empty table");
  }
  const cv::Mat one = cv::Mat::eye(3, 3, CV_64F);
  std::vector<RigidTransform> alone;
  std::vector<cv::Point2f> seen;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::vector<cv::Point2f>& corners : found) {
    const std::vector<cv::Point2f> straight = straightened(corners, camera);
    if (straight.size() != 4) {
      return bad_input({}, "a marker lies where the lens model ends", "use the camera's own calibration");
    }
    const auto own = corners_mm({}, 0, marker_mm);
    cv::Mat rotation;
    cv::Mat translation;
    cv::solvePnP(std::vector<cv::Point3f>(own.begin(), own.end()), straight, one, cv::noArray(), rotation,
                 translation, false, cv::SOLVEPNP_IPPE_SQUARE);
    alone.push_back(pose(rotation, translation));
    middle += alone.back().translation_mm / static_cast<double>(kMarkers);
    seen.insert(seen.end(), straight.begin(), straight.end());
  }
  // Each marker's pose alone is rough, but tells which quarter it lies in and how it is turned.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const RigidTransform& a : alone) {
    normal += a.rotation.col(2);
  }
  normal.normalize();
  const Eigen::Vector3d along = alone[0].translation_mm - middle;
  const Eigen::Vector3d x = (along - normal * normal.dot(along)).normalized();
  const Eigen::Vector3d y = normal.cross(x);
  constexpr double kQuarter = M_PI / 2;
  std::vector<Placed> places;
  for (const RigidTransform& a : alone) {
    const Eigen::Vector3d off = a.translation_mm - middle;
    const double where = std::round(std::atan2(off.dot(y), off.dot(x)) / kQuarter) * kQuarter;
    const Eigen::Vector3d right = a.rotation.col(0);
    const double turn = std::round(std::atan2(right.dot(y), right.dot(x)) / kQuarter) * kQuarter;
    places.push_back({{std::cos(where), std::sin(where)}, turn});
  }
  MarkedTable best;
  best.rms_px = 1e300;
  constexpr double kStep_mm = 0.25;
  for (double circle_mm = marker_mm; circle_mm < 5 * marker_mm; circle_mm += kStep_mm) {
    std::vector<cv::Point3f> corners;
    for (const Placed& placed : places) {
      const auto four = corners_mm(placed, circle_mm, marker_mm);
      corners.insert(corners.end(), four.begin(), four.end());
    }
    cv::Mat rotation;
    cv::Mat translation;
    cv::solvePnP(corners, seen, one, cv::noArray(), rotation, translation);
    const RigidTransform camera_from_table = pose(rotation, translation);
    double square = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector3d p = camera_from_table * Eigen::Vector3d(static_cast<double>(corners[k].x),
                                                                    static_cast<double>(corners[k].y), 0);
      const cv::Point2f& raw = found[k / 4][k % 4];
      square += (camera.project(p) - Eigen::Vector2d(static_cast<double>(raw.x), static_cast<double>(raw.y)))
                    .squaredNorm();
    }
    const double rms_px = std::sqrt(square / static_cast<double>(corners.size()));
    if (rms_px < best.rms_px) {
      best = {camera_from_table, circle_mm, rms_px};
    }
  }
  return best;
}

std::vector<Eigen::Vector3d> stripe_on_plane(const std::vector<Eigen::Vector2d>& stripe_px,
                                             const CameraModel& camera, const Plane& plane,
                                             const Eigen::Vector3d& middle_mm, double radius_mm) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector2d& pixel : stripe_px) {
    const auto ray = camera.undistort(pixel);
    if (!ray) {
      continue;
    }
    const Eigen::Vector3d direction(ray->x(), ray->y(), 1);
    const auto t = plane.along(Eigen::Vector3d::Zero(), direction);
    if (t && *t > 0 && (*t * direction - middle_mm).norm() < radius_mm) {
      out.push_back(*t * direction);
    }
  }
  return out;
}

StripeMiss miss(const Plane& light, const std::vector<Eigen::Vector3d>& stripe_mm) {
  StripeMiss out;
  if (stripe_mm.size() < 2) {
    return out;
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<double> off;
  for (const Eigen::Vector3d& p : stripe_mm) {
    mean += p / static_cast<double>(stripe_mm.size());
    off.push_back(std::abs(light.signed_distance_mm(p)));
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : stripe_mm) {
    scatter += (p - mean) * (p - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  out.median_mm = median_of(std::move(off));
  out.angle_rad = std::asin(std::min(1.0, std::abs(solver.eigenvectors().col(2).dot(light.normal))));
  return out;
}

std::vector<Eigen::Vector2d> crossing_px(const Plane& light, const Plane& plane, const CameraModel& camera,
                                         const Eigen::Vector3d& middle_mm, double radius_mm) {
  const Eigen::Vector3d along = light.normal.cross(plane.normal).normalized();
  Eigen::Matrix3d rows;
  rows << light.normal.transpose(), plane.normal.transpose(), along.transpose();
  const Eigen::Vector3d nearest =
      rows.inverse() * Eigen::Vector3d(light.distance_mm, plane.distance_mm, along.dot(middle_mm));
  std::vector<Eigen::Vector2d> out;
  constexpr double kStep_mm = 0.2;
  for (double s = -radius_mm; s <= radius_mm; s += kStep_mm) {
    const Eigen::Vector3d p = nearest + s * along;
    if (p.z() > 0) {
      out.push_back(camera.project(p));
    }
  }
  return out;
}

}  // namespace dubsar
