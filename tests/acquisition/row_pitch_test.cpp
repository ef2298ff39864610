// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/row_pitch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/units.h"

namespace dubsar {
namespace {

constexpr double kStep = 0.05;
constexpr double kSpeed = 1.5;  // mm/s: a row in 33.3 ms

/// Rows each `period_ms`, a fifth of a step off their places to either side.
void take(RowPitch& pitch, int rows, double period_ms, double speed = kSpeed) {
  for (int row = 0; row < rows; ++row) {
    const double off = row % 2 == 0 ? 0.2 : -0.2;
    pitch.add(row, static_cast<std::int64_t>(1e6 * period_ms * row),
              1e-3 * speed * period_ms * row + off * kStep);
  }
}

TEST(RowPitch, RowsAsFarApartAsWasAskedAreSaidToBeThat) {
  for (const int rows : {0, 1, 2, 5, 40}) {
    RowPitch pitch(kStep, kSpeed, false);
    take(pitch, rows, 1.05e3 * kStep / kSpeed);
    EXPECT_EQ(pitch.is_known(), rows > 16);
    EXPECT_EQ(pitch.value(), kStep) << rows;
    EXPECT_FALSE(pitch.remark()) << rows;
  }
}

TEST(RowPitch, ACameraThatIsSlowerOrFasterThanItTellsIsSeen) {
  RowPitch slow(kStep, kSpeed, false);
  take(slow, 20, 100);
  EXPECT_NEAR(slow.value(), 0.15, 1e-9);
  EXPECT_EQ(slow.remark(),
            "the camera is too slow for the stage: rows came 0.149 mm apart, and the step is "
            "0.05 mm; shorten its exposure, or let the stage go more slowly");
  // Where few came at all, that tells enough.
  RowPitch few(kStep, kSpeed, false);
  take(few, 3, 400);
  EXPECT_NEAR(few.value(), 0.6, 1e-9);
  RowPitch fast(rad_from_deg(0.1), rad_from_deg(3), true);
  for (int row = 0; row < 200; ++row) {
    fast.add(row, row * std::int64_t{6'666'667}, rad_from_deg(0.02 * row));
  }
  EXPECT_NEAR(fast.value(), rad_from_deg(0.02), 1e-6);
  EXPECT_EQ(fast.remark(),
            "the camera is too fast for the stage: rows came 0.02° apart, and the step is 0.1°; "
            "lower its rate, or let the stage go faster");
}

/// At the end of its axis a stage has no room to gather speed before the first row.
TEST(RowPitch, AStageThatGathersSpeedInTheFirstRowsIsNotTakenForASlowOne) {
  RowPitch pitch(kStep, kSpeed, false);
  for (int row = 0; row < 200; ++row) {
    const double s = row * kStep / kSpeed;
    const double there = s < 0.6 ? kSpeed * s * s / 1.2 : kSpeed * (s - 0.3);
    pitch.add(row, static_cast<std::int64_t>(1e9 * s), there);
    EXPECT_EQ(pitch.value(), kStep) << row;
  }
  EXPECT_FALSE(pitch.remark());
}

/// One that does not go as fast as it was told: only where it was tells of that.
TEST(RowPitch, AStageThatIsSlowIsRemarkedOn) {
  RowPitch pitch(kStep, kSpeed, false);
  take(pitch, 40, 1e3 * kStep / kSpeed, 0.5 * kSpeed);
  EXPECT_TRUE(pitch.remark());
}

}  // namespace
}  // namespace dubsar
