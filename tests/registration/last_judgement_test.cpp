// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// What is kept of a judgement must never be given for another.
#include "registration/last_judgement.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/registration/support/field_views.h"

namespace dubsar {
namespace {

class Judged : public ::testing::Test {
 protected:
  Judged() : others_(testing::field_views(4)) {
    scan_ = others_.back();
    others_.pop_back();
    kept_.of(scan_, others_, options_);
  }

  void expect_judged_anew() {
    EXPECT_FALSE(kept_.is_of(scan_, others_));
    const ModelFit now = kept_.of(scan_, others_, options_);
    const ModelFit anew =
        judge_in_model(*scan_.surface, model_scans(others_), scan_.model_from_scanner, options_);
    EXPECT_EQ(now.both().close, anew.both().close);
    EXPECT_EQ(now.both().sent, anew.both().sent);
    EXPECT_EQ(now.both().sum_r2_mm2, anew.both().sum_r2_mm2);
    EXPECT_EQ(now.score, anew.score);
    EXPECT_EQ(now.targets, anew.targets);
    EXPECT_EQ(now.model_from_scanner.translation_mm, anew.model_from_scanner.translation_mm);
  }

  std::vector<PlacedSurface> others_;
  PlacedSurface scan_;
  ModelFitOptions options_;
  LastJudgement kept_;
};

TEST_F(Judged, IsKeptAsLongAsNothingChanges) {
  EXPECT_TRUE(kept_.is_of(scan_, others_));
  const ModelFit anew =
      judge_in_model(*scan_.surface, model_scans(others_), scan_.model_from_scanner, options_);
  EXPECT_EQ(kept_.of(scan_, others_, options_).score, anew.score);
  EXPECT_GT(anew.both().close, 1000);
}

TEST(JudgedNever, IsNothingThatIsKept) {
  EXPECT_FALSE(LastJudgement().is_of({}, {}));
}

TEST_F(Judged, AScanThatMovedIsJudgedAnew) {
  scan_.model_from_scanner.translation_mm.x() += 1e-12;
  expect_judged_anew();
}

TEST_F(Judged, AScanThatTurnedIsJudgedAnew) {
  scan_.model_from_scanner = RigidTransform::from_twist({0, 0, 1e-9}, {0, 0, 0}) * scan_.model_from_scanner;
  expect_judged_anew();
}

TEST_F(Judged, AnotherThatMovedIsSeen) {
  others_[1].model_from_scanner.translation_mm.z() += 0.05;
  expect_judged_anew();
}

TEST_F(Judged, AnotherTakenOutIsSeen) {
  others_.pop_back();
  expect_judged_anew();
}

TEST_F(Judged, AnotherThatCameIsSeen) {
  others_.push_back(testing::field_views(5).back());
  expect_judged_anew();
}

TEST_F(Judged, OthersInAnotherOrderAreSeen) {
  std::swap(others_[0], others_[2]);
  expect_judged_anew();
}

TEST_F(Judged, AScanMadeAnewIsAnother) {
  scan_.surface = rescaled(*scan_.surface, {});
  expect_judged_anew();
}

/// Also where it comes to lie in the memory of the one before.
TEST_F(Judged, AnotherMadeAnewIsAnotherEvenAtTheSameAddress) {
  for (int k = 0; k < 8; ++k) {
    others_[0].surface.reset();
    others_[0].surface = testing::field_views(1, 6).front().surface;
    expect_judged_anew();
  }
}

TEST_F(Judged, KeepsNoSurfaceInMemory) {
  const std::weak_ptr<const ScanSurface> other = others_[0].surface;
  others_.clear();
  EXPECT_TRUE(other.expired());
}

}  // namespace
}  // namespace dubsar
