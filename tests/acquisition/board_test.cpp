// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/board.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/units.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"

namespace dubsar {
namespace {

BoardSpec parsed(const char* text) {
  const Result<BoardSpec> spec = parse_board(text);
  EXPECT_TRUE(spec.has_value()) << text;
  return spec.value_or(BoardSpec{});
}

RigCalibration camera_rig() {
  sim::FrameRigOptions options;
  options.width = 800;
  options.height = 600;
  return sim::frame_rig(options);
}

/// The board turned about x and y, its middle in the middle of the volume.
RigidTransform camera_from_board(const BoardSpec& spec, double about_x_rad, double about_y_rad) {
  RigidTransform pose;
  pose.rotation = (Eigen::AngleAxisd(about_x_rad, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(about_y_rad, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  const Eigen::Vector2d middle = 0.5 * (spec.low_mm() + spec.high_mm());
  pose.translation_mm =
      Eigen::Vector3d(0, 0, 250) - pose.rotation * Eigen::Vector3d(middle.x(), middle.y(), 0);
  return pose;
}

class EveryBoard : public testing::TestWithParam<const char*> {};

TEST_P(EveryBoard, CornersComeBackWhereTheyArePrinted) {
  const BoardSpec spec = parsed(GetParam());
  const RigCalibration rig = camera_rig();
  constexpr int kTexels = 60;
  const RigidTransform pose = camera_from_board(spec, rad_from_deg(20), rad_from_deg(-15));
  const sim::BoardTarget target(board_pattern(spec, kTexels), spec.square_mm / kTexels, -spec.low_mm(), pose);
  sim::FrameOptions optics;
  optics.ambient_signal = 0.4;
  const GrayImage image = sim::FrameRenderer(rig, optics).render(target, false, 0, 1);
  const Result<BoardView> view = find_board(image.view(), spec, "view");
  ASSERT_TRUE(view.has_value()) << view.error().line();
  EXPECT_EQ(static_cast<int>(view->corners_px.size()), spec.corner_count());
  double squares = 0;
  for (std::size_t i = 0; i < view->corners_px.size(); ++i) {
    const double error = (rig.camera.project(pose * view->corners_mm[i]) - view->corners_px[i]).norm();
    EXPECT_LT(error, 0.4);
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(view->corners_px.size())), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Board, EveryBoard, testing::Values("chessboard:7x5:4", "charuco:8x6:5:3.7"));

TEST(Board, SaysWhyItWasNotFound) {
  const BoardSpec spec = parsed("chessboard:7x5:4");
  const GrayImage dark(320, 240, 3);
  const Result<BoardView> none = find_board(dark.view(), spec, "dark.png");
  ASSERT_FALSE(none.has_value());
  EXPECT_NE(none.error().line().find("dark"), std::string::npos);
  const GrayImage burnt(320, 240, 255);
  EXPECT_NE(find_board(burnt.view(), spec, "x").error().what.find("overexposed"), std::string::npos);
  EXPECT_FALSE(find_board({}, spec, "x").has_value());
}

TEST(Board, NamesAreReadAndWritten) {
  EXPECT_EQ(parsed("chessboard:9x6:25").text(), "chessboard:9x6:25");
  EXPECT_EQ(parsed("charuco:9x7:5:3.7").text(), "charuco:9x7:5:3.7");
  for (const char* wrong :
       {"", "chessboard", "chessboard:9x6", "chessboard:9x6:0", "chessboard:2x6:25", "charuco:9x7:5",
        "charuco:9x7:5:6", "charuco:9.5x7:5:3", "board:9x6:25", "chessboard:9x6:nan", "chessboard:9:3:1"}) {
    EXPECT_FALSE(parse_board(wrong).has_value()) << wrong;
  }
}

}  // namespace
}  // namespace dubsar
