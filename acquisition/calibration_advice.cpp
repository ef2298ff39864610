// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an operator should do next: which poses of the board are missing.
#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/calibration.h"
#include "acquisition/calibration_laser.h"
#include "core/units.h"
#include "formats/number_text.h"

namespace dubsar {

namespace {

constexpr double kTiltedRad = rad_from_deg(15);
constexpr std::size_t kEnoughViews = 10;

constexpr std::array<const char*, 9> kParts{"upper left corner", "upper edge", "upper right corner",
                                            "left edge",         "middle",     "right edge",
                                            "lower left corner", "lower edge", "lower right corner"};

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
      out.push_back(std::string("show the board in the ") + kParts[part] + " of the picture");
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
  constexpr std::array<const char*, 4> kSides{"right", "left", "lower", "upper"};
  for (std::size_t side = 0; side < tilted.size(); ++side) {
    if (tilted[side] == 0) {
      out.push_back(std::string("tilt the board by 25 to 40° so that its ") + kSides[side] +
                    " side in the picture comes nearer");
    }
  }
}

void ask_for_stripes(const std::vector<CalibrationView>& views, const Intrinsics& intrinsics,
                     const BoardSpec& board, double margin_mm, const Plane& laser,
                     std::vector<std::string>& out) {
  // Where the laser's plane holds the camera's y more than its x, the stripe runs down the picture.
  const bool runs_down = std::abs(laser.normal.x()) > std::abs(laser.normal.y());
  std::vector<double> depths;
  double first = 1;
  double last = 0;
  for (const StripeSample& sample : stripe_samples(views, intrinsics, board, margin_mm)) {
    depths.push_back(sample.point_mm.z());
    const double along =
        runs_down ? sample.pixel.y() / intrinsics.camera.height : sample.pixel.x() / intrinsics.camera.width;
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
  const auto ask_for_side = [&](const char* side) {
    out.push_back(std::string("show the laser on the board at the ") + side + " side of the picture");
  };
  if (first > 0.25) {
    ask_for_side(runs_down ? "upper" : "left");
  }
  if (last < 0.75) {
    ask_for_side(runs_down ? "lower" : "right");
  }
}

}  // namespace

std::vector<std::string> missing_poses(const std::vector<CalibrationView>& views,
                                       const Intrinsics& intrinsics, const BoardSpec& board,
                                       const Plane* laser, double plate_margin_mm) {
  std::vector<std::string> out;
  ask_for_tilts(intrinsics, out);
  if (laser != nullptr) {
    ask_for_stripes(views, intrinsics, board, plate_margin_mm, *laser, out);
  }
  ask_for_parts(views, intrinsics, out);
  if (intrinsics.used.size() < kEnoughViews) {
    out.push_back("take " + std::to_string(kEnoughViews - intrinsics.used.size()) +
                  " more pictures of the board, each tilted another way");
  }
  return out;
}

}  // namespace dubsar
