// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/known_scans.h"

#include <gtest/gtest.h>

#include "tests/station/support/bumpy_scans.h"

namespace dubsar {
namespace {

RangeGrid scaled(RangeGrid grid, float factor) {
  for (auto* values : {&grid.x, &grid.y, &grid.z}) {
    for (float& v : *values) {
      v *= factor;
    }
  }
  return grid;
}

class KnownScansOf : public ::testing::Test {
 protected:
  KnownScansOf() { grid_.source = "a.ply"; }
  void know(bool is_read, bool dropped = false) {
    StoredScan scan;
    scan.id = 4;
    scan.source = grid_.source;
    scan.samples = static_cast<std::int64_t>(grid_.valid_count());
    scan.dropped = dropped;
    known_.add(scan, is_read ? &grid_ : nullptr);
  }
  [[nodiscard]] KnownAs::Kind found(const RangeGrid& came) const {
    return known_.find(came, [this](int) -> Result<RangeGrid> { return grid_; }).kind;
  }
  RangeGrid grid_ = test::bumpy_scan(0);
  KnownScans known_;
};

TEST_F(KnownScansOf, TheSameScanIsKnownAndAnotherOfItsNameIsNot) {
  for (const bool is_read : {true, false}) {
    known_ = {};
    know(is_read);
    EXPECT_EQ(found(grid_), KnownAs::Kind::kSame);
    EXPECT_EQ(found(scaled(grid_, 1.0000001F)), KnownAs::Kind::kSame) << "the last digit of a float";
    EXPECT_EQ(found(scaled(grid_, 1.001F)), KnownAs::Kind::kNamesake);
    RangeGrid other = grid_;
    other.source = "b.ply";
    EXPECT_EQ(found(other), KnownAs::Kind::kNew);
    other = test::bumpy_scan(1);
    other.source = "a.ply";
    EXPECT_EQ(found(other), KnownAs::Kind::kNamesake);
  }
}

TEST_F(KnownScansOf, AUnitIsToldAndOfAScanThatWasTakenOutIsNoMatter) {
  know(true);
  for (const double factor : {1000.0, 10.0, 25.4, 0.001, 0.1}) {
    const RangeGrid came = scaled(grid_, static_cast<float>(factor));
    EXPECT_EQ(found(came), KnownAs::Kind::kOtherUnit);
    EXPECT_NEAR(unit_between(grid_, came).value_or(0), factor, 1e-9);
  }
  EXPECT_EQ(found(scaled(grid_, 100)), KnownAs::Kind::kOtherUnit) << "metres in place of centimetres";
  EXPECT_EQ(found(scaled(grid_, 50)), KnownAs::Kind::kNamesake);
  known_ = {};
  know(false, true);
  EXPECT_EQ(found(grid_), KnownAs::Kind::kSame);
  EXPECT_EQ(found(scaled(grid_, 1000)), KnownAs::Kind::kNamesake);
}

TEST_F(KnownScansOf, OneThatCannotBeReadIsToldByItsNumberOfSamples) {
  know(false, true);
  const auto unread = [](int) -> Result<RangeGrid> { return bad_input("a.grid", "damaged"); };
  EXPECT_EQ(known_.find(grid_, unread).kind, KnownAs::Kind::kSame);
  RangeGrid other = grid_;
  other.valid[other.index(other.rows / 2, other.cols / 2)] = 0;
  EXPECT_EQ(known_.find(other, unread).kind, KnownAs::Kind::kNamesake);
}

}  // namespace
}  // namespace dubsar
