// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/motion_budget.h"

#include <gtest/gtest.h>

#include <array>

namespace dubsar::ui {
namespace {

/// A surface of 13.8 million faces in levels, on a machine that takes so long for any picture, or a quarter
/// over half the pixels a side, and so long for each face.
class Turned {
 public:
  Turned(double picture_s, double million_faces_s)
      : picture_s_(picture_s), million_faces_s_(million_faces_s) {}

  void turn(int pictures, double more_s = 0) {
    for (int k = 0; k < pictures; ++k) {
      if (budget.is_slow() != was_slow_) {
        budget.begin_other_pictures();
        was_slow_ = budget.is_slow();
      }
      drawn = kLevels.front();
      for (const std::size_t faces : kLevels) {
        drawn = faces <= budget.faces() ? faces : drawn;
      }
      spent_s = (budget.is_slow() ? picture_s_ / 4 : picture_s_) + more_s +
                million_faces_s_ * 1e-6 * static_cast<double>(drawn);
      budget.took(drawn, drawn == kLevels.back(), spent_s);
    }
  }

  MotionBudget budget;
  std::size_t drawn = 0;
  double spent_s = 0;

 private:
  static constexpr std::array<std::size_t, 5> kLevels{33'000, 132'000, 518'000, 2'000'000, 13'800'000};
  double picture_s_, million_faces_s_;
  bool was_slow_ = true;
};

TEST(MotionBudget, AFastCardDrawsAsMuchAsItCanTwoHundredTimesASecond) {
  Turned card(0.0029, 0.0018);  // as a data centre's card was measured
  card.turn(40);
  EXPECT_FALSE(card.budget.is_slow());
  EXPECT_EQ(card.drawn, 518'000U);
  EXPECT_LT(card.spent_s, 0.005);
  Turned faster(0.0005, 0.0002);
  faster.turn(40);
  EXPECT_EQ(faster.drawn, 13'800'000U) << "all there are";
}

TEST(MotionBudget, ALampThatTakesLongerTakesAwayFaces) {
  Turned card(0.0005, 0.0020);
  card.turn(40);
  EXPECT_EQ(card.drawn, 2'000'000U);
  card.budget.begin_other_pictures();
  card.turn(40, 0.0020);
  EXPECT_EQ(card.drawn, 518'000U);
  card.budget.begin_other_pictures();
  card.turn(40);
  EXPECT_EQ(card.drawn, 2'000'000U) << "and gives them back";
}

TEST(MotionBudget, AHiccupTakesNothingAway) {
  Turned card(0.0005, 0.0020);
  card.turn(40);
  card.turn(1, 0.02);
  EXPECT_EQ(card.drawn, 2'000'000U);
  card.turn(1);
  EXPECT_EQ(card.drawn, 2'000'000U);
}

TEST(MotionBudget, AProcessorKeepsToFewAndToHalfThePixels) {
  Turned processor(0.12, 0.6);
  processor.turn(40);
  EXPECT_TRUE(processor.budget.is_slow());
  EXPECT_LE(processor.budget.faces(), 3 * kFacesInMotion);
  EXPECT_GE(processor.budget.faces(), kFacesInMotion);
}

}  // namespace
}  // namespace dubsar::ui
