// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an operator should do next: which poses of the board are missing.
#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/calibration.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/calibration_volume.h"
#include "core/number_text.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kTiltedRad = rad_from_deg(15);
constexpr std::size_t kEnoughViews = 10;

// Whole sentences, as the window has them in other languages.
constexpr std::array<const char*, 9> kParts{"show the board in the upper left corner of the picture",
                                            "show the board in the upper edge of the picture",
                                            "show the board in the upper right corner of the picture",
                                            "show the board in the left edge of the picture",
                                            "show the board in the middle of the picture",
                                            "show the board in the right edge of the picture",
                                            "show the board in the lower left corner of the picture",
                                            "show the board in the lower edge of the picture",
                                            "show the board in the lower right corner of the picture"};
constexpr std::array<const char*, 4> kTilts{
    "tilt the board by 25 to 40° so that its right side in the picture comes nearer",
    "tilt the board by 25 to 40° so that its left side in the picture comes nearer",
    "tilt the board by 25 to 40° so that its lower side in the picture comes nearer",
    "tilt the board by 25 to 40° so that its upper side in the picture comes nearer"};
constexpr const char* kLaserUpper = "show the laser on the board at the upper side of the picture";
constexpr const char* kLaserLower = "show the laser on the board at the lower side of the picture";
constexpr const char* kLaserLeft = "show the laser on the board at the left side of the picture";
constexpr const char* kLaserRight = "show the laser on the board at the right side of the picture";

void ask_for_parts(const std::vector<CalibrationView>& views, const Intrinsics& intrinsics,
                   std::vector<std::string>& out) {
  std::array<int, 9> corners{};
  for (const std::size_t i : intrinsics.used) {
    const BoardView& board = views[i].board;
    for (const Eigen::Vector2d& c : board.corners_px) {
      const int column = std::clamp(static_cast<int>(3 * c.x() / board.width), 0, 2);
      const int row = std::clamp(static_cast<int>(3 * c.y() / board.height), 0, 2);
      ++corners[static_cast<std::size_t>(3 * row + column)];
    }
  }
  for (std::size_t part = 0; part < corners.size(); ++part) {
    if (corners[part] == 0) {
      out.emplace_back(kParts[part]);
    }
  }
}

void ask_for_tilts(const Intrinsics& intrinsics, std::vector<std::string>& out) {
  // The board's normal points away from the camera: towards +x when its right side is nearer.
  std::array<int, 4> tilted{};
  for (const RigidTransform& pose : intrinsics.camera_from_board) {
    const Eigen::Vector3d n = pose.rotation.col(2);
    const double about_y = std::atan2(n.x(), n.z());
    const double about_x = std::atan2(n.y(), n.z());
    tilted[0] += about_y > kTiltedRad ? 1 : 0;
    tilted[1] += about_y < -kTiltedRad ? 1 : 0;
    tilted[2] += about_x > kTiltedRad ? 1 : 0;
    tilted[3] += about_x < -kTiltedRad ? 1 : 0;
  }
  for (std::size_t side = 0; side < tilted.size(); ++side) {
    if (tilted[side] == 0) {
      out.emplace_back(kTilts[side]);
    }
  }
}

void ask_for_stripes(const std::vector<CalibrationView>& views, const Intrinsics& intrinsics,
                     const BoardSpec& board, double margin_mm, double depth_range_mm, const Plane& laser,
                     std::vector<std::string>& out) {
  const bool down = runs_down(laser);
  std::vector<double> depths;
  double first = 1;
  double last = 0;
  for (const StripeSample& sample : stripe_samples(views, intrinsics, board, margin_mm)) {
    depths.push_back(sample.point_mm.z());
    const double along =
        down ? sample.pixel.y() / intrinsics.camera.height : sample.pixel.x() / intrinsics.camera.width;
    first = std::min(first, along);
    last = std::max(last, along);
  }
  const auto reach = laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  if (depths.empty() || !reach) {
    out.emplace_back("take pictures with the laser on the board");
    return;
  }
  const auto [near, far] = std::minmax_element(depths.begin(), depths.end());
  // A tenth of the distance both ways is what a plane needs for its tilt to show.
  const double wanted = 0.04 * *reach;
  if (*near > *reach - wanted) {
    out.push_back("show the laser on the board " + number_text(std::round(2 * wanted)) +
                  " mm nearer to the camera");
  }
  if (*far < *reach + wanted) {
    out.push_back("show the laser on the board " + number_text(std::round(2 * wanted)) +
                  " mm farther from the camera");
  }
  const SeenDepth seen = seen_depth(intrinsics.camera, laser, depth_range_mm);
  const double held = std::floor(2 * std::min(seen.near_mm, seen.far_mm));
  if (held < depth_range_mm - 1) {
    out.push_back("the picture holds " + number_text(held) + " mm of the depth range of " +
                  number_text(std::round(depth_range_mm)) +
                  " mm, and nothing is said of the rest: name a smaller depth range, or a larger region of "
                  "the camera");
  }
  if (first > 0.25) {
    out.emplace_back(down ? kLaserUpper : kLaserLeft);
  }
  if (last < 0.75) {
    out.emplace_back(down ? kLaserLower : kLaserRight);
  }
}

}  // namespace

std::vector<std::string> missing_poses(const std::vector<CalibrationView>& views,
                                       const Intrinsics& intrinsics, const BoardSpec& board,
                                       const Plane* laser, double plate_margin_mm, double depth_range_mm) {
  std::vector<std::string> out;
  ask_for_tilts(intrinsics, out);
  if (laser != nullptr) {
    ask_for_stripes(views, intrinsics, board, plate_margin_mm, depth_range_mm, *laser, out);
  }
  ask_for_parts(views, intrinsics, out);
  if (intrinsics.used.size() < kEnoughViews) {
    out.push_back("take more pictures of the board, each tilted another way: " +
                  std::to_string(kEnoughViews - intrinsics.used.size()));
  }
  return out;
}

}  // namespace dubsar
