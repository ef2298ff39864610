// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "acquisition/calibration_views.h"
#include "core/number_text.h"
#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr const char* kMend = "take more pictures of the board: see which poses are asked for";

std::string rounded(double value) {
  return number_text(std::round(value * 100) / 100);
}

constexpr double kRepeatedPx = 0.02;  // a board that is shown again comes back to no such place

/// Whether both are one picture: the same corners at the same places, mirror and stage where they were.
bool repeats(const CalibrationView& a, const CalibrationView& b) {
  if (a.board.corners_px.size() != b.board.corners_px.size() || a.fixed != b.fixed ||
      a.stage_position != b.stage_position || a.mirror_position != b.mirror_position) {
    return false;
  }
  for (std::size_t i = 0; i < a.board.corners_px.size(); ++i) {
    if ((a.board.corners_mm[i] - b.board.corners_mm[i]).norm() > 1e-6 ||
        (a.board.corners_px[i] - b.board.corners_px[i]).norm() > kRepeatedPx) {
      return false;
    }
  }
  return true;
}

struct Solved {
  CameraModel camera;
  std::vector<RigidTransform> poses;
  std::vector<double> rms_px;
  double total_rms_px = 0;
};

int flags_for(DistortionTerms terms) {
  switch (terms) {
    case DistortionTerms::kThree:
      return cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3;
    case DistortionTerms::kFour:
      return cv::CALIB_FIX_K3;
    case DistortionTerms::kAll:
      break;
  }
  return 0;
}

Solved solve(const std::vector<CalibrationView>& views, const std::vector<std::size_t>& used, int flags) {
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> image;
  for (const std::size_t i : used) {
    const BoardView& board = views[i].board;
    object.emplace_back();
    image.emplace_back();
    for (std::size_t k = 0; k < board.corners_px.size(); ++k) {
      object.back().emplace_back(board.corners_mm[k].x(), board.corners_mm[k].y(), 0);
      image.back().emplace_back(board.corners_px[k].x(), board.corners_px[k].y());
    }
  }
  const BoardView& first = views[used.front()].board;
  cv::Mat matrix;
  cv::Mat distortion;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  cv::calibrateCamera(object, image, {first.width, first.height}, matrix, distortion, turns, shifts, flags,
                      {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-12});
  Solved out;
  const auto d = [&](int i) { return distortion.at<double>(i); };
  out.camera = {first.width,
                first.height,
                matrix.at<double>(0, 0),
                matrix.at<double>(1, 1),
                matrix.at<double>(0, 2),
                matrix.at<double>(1, 2),
                d(0),
                d(1),
                d(2),
                d(3),
                d(4)};
  double all = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Eigen::Vector3d turn(turns[i].at<double>(0), turns[i].at<double>(1), turns[i].at<double>(2));
    RigidTransform pose = RigidTransform::from_twist(turn, Eigen::Vector3d::Zero());
    pose.translation_mm = {shifts[i].at<double>(0), shifts[i].at<double>(1), shifts[i].at<double>(2)};
    const BoardView& board = views[used[i]].board;
    double squares = 0;
    for (std::size_t k = 0; k < board.corners_px.size(); ++k) {
      squares += (out.camera.project(pose * board.corners_mm[k]) - board.corners_px[k]).squaredNorm();
    }
    out.poses.push_back(pose);
    out.rms_px.push_back(std::sqrt(squares / static_cast<double>(board.corners_px.size())));
    all += squares;
    count += board.corners_px.size();
  }
  out.total_rms_px = std::sqrt(all / static_cast<double>(count));
  return out;
}

/// The largest angle between the normals of two boards.
double tilt_spread_rad(const std::vector<RigidTransform>& poses) {
  double most = 0;
  for (const RigidTransform& a : poses) {
    for (const RigidTransform& b : poses) {
      most = std::max(most, std::acos(std::clamp(a.rotation.col(2).dot(b.rotation.col(2)), -1.0, 1.0)));
    }
  }
  return most;
}

}  // namespace

DistortionTerms terms_for(const CameraModel& camera) {
  const double x = std::max(camera.cx_px, camera.width - camera.cx_px) / camera.fx_px;
  const double y = std::max(camera.cy_px, camera.height - camera.cy_px) / camera.fy_px;
  const double r2 = x * x + y * y;
  return r2 < 0.05 ? DistortionTerms::kThree : r2 < 0.12 ? DistortionTerms::kFour : DistortionTerms::kAll;
}

Result<Intrinsics> find_intrinsics(const std::vector<CalibrationView>& views,
                                   const IntrinsicsOptions& options) {
  const std::size_t least = std::max<std::size_t>(3, options.least_views);
  Intrinsics out;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoardView& board = views[i].board;
    const BoardView& first = views.front().board;
    if (board.width != first.width || board.height != first.height) {
      return bad_input(board.name,
                       "this picture has " + std::to_string(board.width) + " x " +
                           std::to_string(board.height) + " pixels, the first one " +
                           std::to_string(first.width) + " x " + std::to_string(first.height),
                       "take all pictures with the same region of the same camera");
    }
    const auto same = std::ranges::find_if(
        out.used, [&](std::size_t earlier) { return repeats(views[earlier], views[i]); });
    if (board.corners_px.size() < 6) {
      out.left_out.push_back(board.name + ": too few corners");
    } else if (same != out.used.end()) {
      out.left_out.push_back(board.name + ": the same picture as " + views[*same].board.name);
    } else {
      out.used.push_back(i);
    }
  }
  const auto too_few = [&]() {
    return bad_input({},
                     "the board was found in " + std::to_string(out.used.size()) + " pictures, " +
                         std::to_string(least) + " are the least" +
                         (out.left_out.empty() ? "" : " (left out: " + out.left_out.front() + ")"),
                     kMend);
  };
  if (out.used.size() < least) {
    return too_few();
  }
  try {
    Solved solved = solve(views, out.used, flags_for(DistortionTerms::kThree));
    const int flags = flags_for(terms_for(solved.camera));
    solved = solve(views, out.used, flags);
    while (options.outlier_factor > 0) {
      const auto worst = std::max_element(solved.rms_px.begin(), solved.rms_px.end());
      if (*worst < 0.5 || *worst < options.outlier_factor * median_of(solved.rms_px)) {
        break;
      }
      const auto index = worst - solved.rms_px.begin();
      out.left_out.push_back(views[out.used[static_cast<std::size_t>(index)]].board.name +
                             ": its corners are off by " + rounded(*worst) + " px, those of the others by " +
                             rounded(median_of(solved.rms_px)) + " px");
      out.used.erase(out.used.begin() + index);
      if (out.used.size() < least) {
        return too_few();
      }
      solved = solve(views, out.used, flags);
    }
    if (!(solved.total_rms_px < 1.5)) {
      return bad_input(
          {}, "the corners are off by " + rounded(solved.total_rms_px) + " px on average",
          "see that the board is flat, the named size is the printed one and the pictures are sharp");
    }
    if (tilt_spread_rad(solved.poses) < rad_from_deg(15)) {
      return bad_input({}, "the board was never tilted by more than 15°, which leaves the focal length open",
                       "tilt the board by 25 to 40° to each side");
    }
    if (Status fine = solved.camera.check("camera"); !fine) {
      return bad_input({}, "the pictures do not determine the camera: " + fine.error().what,
                       "take more pictures, with the board in every corner of them");
    }
    out.camera = solved.camera;
    out.camera_from_board = std::move(solved.poses);
    out.rms_px = solved.total_rms_px;
  } catch (const cv::Exception& defect) {
    return bad_input({}, "the pictures do not determine the camera: " + defect.err, kMend);
  }
  return out;
}

}  // namespace dubsar
