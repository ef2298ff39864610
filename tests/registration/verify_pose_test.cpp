// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/verify_pose.h"

#include <gtest/gtest.h>

#include "core/units.h"

namespace dubsar {
namespace {

/// A pose as the relief of two scans of the same clay shows it: nothing speaks against it.
ModelFit right_pose() {
  ModelFit fit;
  fit.icp.pairs = 4000;
  fit.icp.stability = 0.03;
  fit.icp.rms_mm = 0.08;
  fit.residual_sigma_mm = 0.08;
  fit.outward.sent = fit.inward.sent = 8000;
  fit.outward.close = fit.inward.close = 4500;
  fit.outward.apart = fit.inward.apart = 500;
  fit.overlap = fit.best_pair_overlap = 0.6;
  fit.partner_agreement = fit.both().agreement();
  for (int i = 0; i < 100; ++i) {  // a correlation of 0.9 or so
    const double a = i % 10 - 4.5;
    fit.relief.height.add(a, a + (i % 7 - 3) * 0.5);
  }
  fit.significance = 25;
  fit.significance_off_rims = 20;
  fit.slid_significance = 10;
  fit.score = 3;
  return fit;
}

/// Half a turn away: two stretches of one moulding, along which the scan slides as it likes.
ModelFit on_a_moulding() {
  ModelFit fit = right_pose();
  fit.model_from_scanner = RigidTransform::from_twist({0, 0, kPi}, {0, 0, 0});
  fit.icp.stability = 1e-4;
  fit.overlap = fit.best_pair_overlap = 0.12;
  fit.significance = 21;
  fit.significance_off_rims = 20;
  fit.slid_significance = 21;
  fit.score = 2.8;
  return fit;
}

PoseVerdict verdict(std::vector<ModelFit> fits) {
  return verify_pose(fits, VerifyOptions{});
}

TEST(VerifyPose, TakesThePoseThatReliefAndShapeShow) {
  ASSERT_GT(right_pose().relief.correlation(), 0.8);
  EXPECT_EQ(verdict({right_pose()}).status, PoseStatus::kRegistered);
}

TEST(VerifyPose, AMouldingThatAgreesAllAlongIsNoRival) {
  std::vector<ModelFit> fits{right_pose(), on_a_moulding()};
  EXPECT_EQ(verify_pose(fits, VerifyOptions{}).status, PoseStatus::kRegistered);
  EXPECT_LT(fits.front().model_from_scanner.angle_rad(), 0.1);
  std::swap(fits[0], fits[1]);
  fits[0].score = 3.5;  // not either where it scores higher
  EXPECT_EQ(verify_pose(fits, VerifyOptions{}).status, PoseStatus::kRegistered);
  EXPECT_LT(fits.front().model_from_scanner.angle_rad(), 0.1);
}

TEST(VerifyPose, AReliefThatHoldsAnotherPoseIsARival) {
  ModelFit held = on_a_moulding();
  held.slid_significance = 8;
  EXPECT_EQ(verdict({right_pose(), held}).status, PoseStatus::kUnsure);
  held.slid_significance = held.significance;
  held.icp.stability = 0.03;  // or its shape holds it
  EXPECT_EQ(verdict({right_pose(), held}).status, PoseStatus::kUnsure);
}

TEST(VerifyPose, WhatAgreesAsWellALittleWayOffIsNotSure) {
  ModelFit other_tablet = right_pose();
  other_tablet.significance = 7.2;
  other_tablet.slid_significance = 7.6;
  EXPECT_EQ(verdict({other_tablet}).status, PoseStatus::kUnsure);
  other_tablet.slid_significance = 6.4;  // the worst of the right ones
  EXPECT_EQ(verdict({other_tablet}).status, PoseStatus::kRegistered);
}

TEST(VerifyPose, WhatFallsTogetherAtSharpRimsIsNotSure) {
  ModelFit box = right_pose();
  box.significance = 10;
  box.slid_significance = 8;
  box.significance_off_rims = 3.3;  // as an edge of a box on another of its edges
  EXPECT_EQ(verdict({box}).status, PoseStatus::kUnsure);
  box.significance_off_rims = 9.5;
  EXPECT_EQ(verdict({box}).status, PoseStatus::kRegistered);
}

TEST(VerifyPose, AMouldingAloneTellsNoPose) {
  EXPECT_EQ(verdict({on_a_moulding()}).status, PoseStatus::kUnsure);
}

TEST(VerifyPose, AReliefThatFitsItselfTurnedTellsNoPose) {
  ModelFit ruled = right_pose();
  ruled.repeats_turned_rad = kPi;
  const PoseVerdict turned = verdict({ruled});
  EXPECT_EQ(turned.status, PoseStatus::kUnsure);
  EXPECT_EQ(turned.reason, "two poses fit, 180 degrees apart; click one point on both scans");
  ruled.repeats_turned_rad = 0;  // moved along
  EXPECT_EQ(verdict({ruled}).status, PoseStatus::kUnsure);
  ruled.told = true;
  EXPECT_EQ(verdict({ruled}).status, PoseStatus::kRegistered);
}

/// Of a hand turn that was asked for, onto 200 places: nothing written agrees.
ModelFit turned_by_hand(double residual) {
  ModelFit fit = right_pose();
  fit.told = fit.told_by_rig = true;
  fit.significance = 2;
  fit.places = 200;
  fit.icp.rms_mm = residual * fit.residual_sigma_mm;
  return fit;
}

TEST(VerifyPose, WhereTheRigLeadsTheResidualsMustBeNoise) {
  EXPECT_EQ(verdict({turned_by_hand(1.1)}).status, PoseStatus::kRegistered) << "to within three sigmas";
  const PoseVerdict other = verdict({turned_by_hand(1.2)});
  EXPECT_EQ(other.status, PoseStatus::kUnsure);
  EXPECT_NE(other.reason.find("another tablet may lie there"), std::string::npos) << other.reason;
  ModelFit written = turned_by_hand(1.2);
  written.significance = 25;
  EXPECT_EQ(verdict({written}).status, PoseStatus::kRegistered);
  ModelFit clicked = turned_by_hand(1.2);
  clicked.told_by_rig = false;
  EXPECT_EQ(verdict({clicked}).status, PoseStatus::kRegistered);
  ModelFit few_places = turned_by_hand(1.2);
  few_places.places = 50;
  EXPECT_EQ(verdict({few_places}).status, PoseStatus::kRegistered);
}

/// As on a model of many scans of a real scanner: well beside the one that it shares most with, off others.
ModelFit among_many(double partner_agreement) {
  ModelFit fit = right_pose();
  fit.icp.rms_mm = 1.4 * fit.residual_sigma_mm;
  fit.outward.apart = fit.inward.apart = 4500;
  fit.outward.missing = fit.inward.missing = 500;
  fit.partner_agreement = partner_agreement;
  return fit;
}

TEST(VerifyPose, AgreementWithItsPartnerCountsWhereTheReliefIsSure) {
  EXPECT_EQ(verdict({among_many(0.5)}).status, PoseStatus::kUnsure);
  EXPECT_EQ(verdict({among_many(0.85)}).status, PoseStatus::kRegistered);
  ModelFit little_relief = among_many(0.85);
  little_relief.significance = 4;
  EXPECT_EQ(verdict({little_relief}).status, PoseStatus::kUnsure);
  ModelFit through = among_many(0.85);
  through.outward.in_front = 400;  // another camera saw through it
  EXPECT_EQ(verdict({through}).status, PoseStatus::kUnsure);
}

}  // namespace
}  // namespace dubsar
