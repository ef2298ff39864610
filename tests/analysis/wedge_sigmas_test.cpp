// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How sure a wedge's measures are.

#include "analysis/wedge_sigmas.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dubsar {
namespace {

constexpr double kSpacingMm = 0.05;

/// A wedge 0.5 mm deep whose lines and planes agree; its sigmas with what is seen of its faces.
struct Fitted {
  WedgeFaces faces;
  InnerEdges edges;
  FacesSeen seen;

  Fitted() {
    for (std::size_t k = 0; k < 3; ++k) {
      faces.plane[k].sigma_rad = 0.002;
      edges.edge[k].direction = Eigen::Vector3d(0.8, 0, 0.6);
      edges.edge[k].sigma_rad = 0.005;
      edges.edge[k].off_planes_rad = 0.002;
      seen.gap_mm[k] = 0.05;
    }
  }
  [[nodiscard]] WedgeSigma sigma() const {
    Wedge wedge;
    wedge.depth_mm = 0.5;
    wedge.edge_lengths_mm = {1, 1, 1};
    wedge.volume_mm3 = 0.3;
    note_sigmas(faces, edges, seen, kSpacingMm, ExitDefinition::kSurface, &wedge);
    return wedge.sigma;
  }
};

TEST(WedgeSigmas, OfAWholeWedgeAreThoseOfItsFits) {
  const WedgeSigma sigma = Fitted().sigma();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(sigma.opening_rad[k], 0.012);
    EXPECT_LT(sigma.edge_rad[k], 0.012);
  }
}

TEST(WedgeSigmas, GrowWithWhatIsMissingOfAFace) {
  Fitted half;
  half.seen.coverage[0] = 0.5;  // between edges 0 and 1
  const WedgeSigma whole = Fitted().sigma();
  const WedgeSigma sigma = half.sigma();
  EXPECT_GT(sigma.opening_rad[0], 5 * whole.opening_rad[0]);
  EXPECT_GT(sigma.opening_rad[1], 5 * whole.opening_rad[1]);
  EXPECT_EQ(sigma.opening_rad[2], whole.opening_rad[2]) << "of the two faces that are whole";
  EXPECT_GT(sigma.edge_rad[1], 3 * whole.edge_rad[1]);
  EXPECT_GT(sigma.volume_mm3, whole.volume_mm3);
  half.seen.coverage[0] = 0.9;
  EXPECT_LT(half.sigma().opening_rad[0], 1.2 * whole.opening_rad[0]);
}

TEST(WedgeSigmas, GrowWhereLineAndPlanesDisagreeOrThereIsNoLine) {
  Fitted askew;
  askew.edges.edge[1].off_planes_rad = 0.1;
  Fitted none;
  none.edges.edge[1].off_planes_rad = std::nan("");
  for (const Fitted* fitted : {&askew, &none}) {
    EXPECT_GT(fitted->sigma().opening_rad[1], 0.09);
    EXPECT_GT(fitted->sigma().edge_rad[1], 0.08);
    EXPECT_EQ(fitted->sigma().edge_rad[0], Fitted().sigma().edge_rad[0]);
  }
}

TEST(WedgeSigmas, OfAFaceApartFromTheDepthPointAreLarge) {
  Fitted apart;
  apart.seen.gap_mm[1] = 0.4;
  EXPECT_GT(apart.sigma().face_slope_rad[1], 0.25);
  EXPECT_LT(apart.sigma().face_slope_rad[0], 0.03);
  apart.seen.gap_mm = {0.4, 0.4, 0.4};
  EXPECT_LT(apart.sigma().face_slope_rad[1], 0.03) << "dirt over the depth point hides all three";
}

TEST(WedgeSigmas, GrowWhereEveryFaceIsWornAndNotWhereOneIsBent) {
  const WedgeSigma sharp = Fitted().sigma();
  Fitted bent;
  bent.seen.turn_rad = {0.1, 0.1, -0.01};
  EXPECT_EQ(bent.sigma().opening_rad, sharp.opening_rad);
  EXPECT_EQ(bent.sigma().depth_mm, sharp.depth_mm);
  Fitted worn;
  worn.seen.turn_rad = {0.1, 0.15, 0.1};
  const WedgeSigma sigma = worn.sigma();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GT(sigma.opening_rad[k], 0.25);
    EXPECT_LT(sigma.opening_rad[k], 0.30);
  }
  EXPECT_GT(sigma.depth_mm, 0.09);
  EXPECT_GT(sigma.depth_point_mm, 0.09);
  EXPECT_GT(sigma.edge_rad[1], 4 * sigma.edge_rad[0]) << "edge 0, between faces worn alike";
}

TEST(WedgeSigmas, OfSlopesAndDepthGrowBesideARim) {
  const WedgeSigma flat = Fitted().sigma();
  Fitted curved;
  curved.seen.rim_rad = 0.02;
  EXPECT_EQ(curved.sigma().edge_slope_rad, flat.edge_slope_rad) << "as sides of tablets are";
  Fitted beside;
  beside.seen.rim_rad = 0.12;
  const WedgeSigma sigma = beside.sigma();
  EXPECT_GT(sigma.edge_slope_rad[0], 0.1);
  EXPECT_GT(sigma.face_slope_rad[0], 0.1);
  EXPECT_GT(sigma.depth_mm, 0.05);
  EXPECT_EQ(sigma.opening_rad, flat.opening_rad) << "which no surface is needed for";
}

}  // namespace
}  // namespace dubsar
