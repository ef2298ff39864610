// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which wedges a view of the tablet shows, and where on the picture.
#include "archive/wedges_in_view.h"

#include <gtest/gtest.h>

#include "archive/render.h"
#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

/// The marks of the box, as if they were wedges: on the obverse towards +x +y, on the reverse towards +x -y.
constexpr double kObverseZ = 6;

Wedge wedge_at(const Eigen::Vector3d& middle, const Eigen::Vector3d& normal) {
  Wedge wedge;
  wedge.surface_normal = normal;
  const Eigen::Vector3d along = normal.unitOrthogonal();
  const Eigen::Vector3d across = normal.cross(along);
  wedge.outer_vertices_mm = {middle + along, middle - 0.5 * along + across, middle - 0.5 * along - across};
  wedge.depth_point_mm = middle - 0.5 * normal;
  return wedge;
}

std::vector<WedgeOnPicture> on_face(const std::vector<Wedge>& wedges, const Mesh& mesh, Face face,
                                    const RigidTransform& tablet_from_model = {}) {
  RenderOptions options;
  options.mm_per_px = 0.05;
  options.margin_px = 0;
  const RenderScene scene(mesh);
  const ViewCamera camera = face_camera(face, tablet_from_model);
  return wedges_in_view(wedges, scene, camera, framing_of(scene, camera, options).value());
}

TEST(WedgesInView, AreWhereThePictureShowsThem) {
  const Mesh box = coloured_box(30, 24, 12);
  const std::vector<Wedge> wedges{wedge_at({10, 8, kObverseZ}, Eigen::Vector3d::UnitZ()),
                                  wedge_at({10, -8, -kObverseZ}, -Eigen::Vector3d::UnitZ())};
  const auto front = on_face(wedges, box, Face::kObverse);
  ASSERT_EQ(front.size(), 1U);
  EXPECT_EQ(front[0].wedge, 0U);
  Eigen::Vector2d middle = (front[0].corners_px[0] + front[0].corners_px[1] + front[0].corners_px[2]) / 3;
  EXPECT_LT((middle - Eigen::Vector2d((15 + 10) / 0.05, (12 - 8) / 0.05)).norm(), 0.6);
  // The reverse is turned over about the horizontal axis: -y comes up.
  const auto back = on_face(wedges, box, Face::kReverse);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].wedge, 1U);
  middle = (back[0].corners_px[0] + back[0].corners_px[1] + back[0].corners_px[2]) / 3;
  EXPECT_LT((middle - Eigen::Vector2d((15 + 10) / 0.05, (12 - 8) / 0.05)).norm(), 0.6);
  for (const Face edge : {Face::kLeft, Face::kRight, Face::kTop, Face::kBottom}) {
    EXPECT_TRUE(on_face(wedges, box, edge).empty()) << to_string(edge);
  }
}

TEST(WedgesInView, NearAnEdgeThereAreTwoViews) {
  const std::vector<Wedge> wedges{wedge_at({14, 0, kObverseZ - 1}, Eigen::Vector3d(1, 0, 1).normalized())};
  Mesh wall;  // as a bevel between obverse and right edge
  add_quad(wall, {{{13, -9, 6}, {15, -9, 4}, {15, 9, 4}, {13, 9, 6}}}, kMarkColour);
  EXPECT_EQ(on_face(wedges, wall, Face::kObverse).size(), 1U);
  EXPECT_EQ(on_face(wedges, wall, Face::kRight).size(), 1U);
  EXPECT_TRUE(on_face(wedges, wall, Face::kLeft).empty());
  EXPECT_TRUE(on_face(wedges, wall, Face::kTop).empty());
}

TEST(WedgesInView, WhatLiesInFrontHidesThem) {
  Mesh box = coloured_box(30, 24, 12);
  const std::vector<Wedge> wedges{wedge_at({0, 0, kObverseZ}, Eigen::Vector3d::UnitZ())};
  ASSERT_EQ(on_face(wedges, box, Face::kObverse).size(), 1U);
  Mesh lower = box;
  add_quad(lower, {{{-3, -3, 6.2F}, {3, -3, 6.2F}, {3, 3, 6.2F}, {-3, 3, 6.2F}}}, kMarkColour);
  EXPECT_EQ(on_face(wedges, lower, Face::kObverse).size(), 1U) << "no more than the planes lie off the clay";
  add_quad(box, {{{-3, -3, 9}, {3, -3, 9}, {3, 3, 9}, {-3, 3, 9}}}, kMarkColour);
  EXPECT_TRUE(on_face(wedges, box, Face::kObverse).empty());
}

TEST(WedgesInView, WhatIsNoWedgeOfThisSurfaceIsShownNowhere) {
  const Mesh box = coloured_box(30, 24, 12);
  EXPECT_TRUE(on_face({Wedge{}, wedge_at({900, 0, kObverseZ}, Eigen::Vector3d::UnitZ())}, box, Face::kObverse)
                  .empty());
}

}  // namespace
}  // namespace dubsar
