// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that are known again in another form; those that are not.
#include "core/same_marks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/random.h"
#include "core/scan_copies.h"
#include "tests/support/height_field.h"
#include "tests/support/other_forms.h"

namespace dubsar {
namespace {

using test::cropped;
using test::moved;
using test::reversed;
using test::rounded;
using test::transposed;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kSpacingMm = 0.2;

/// Wedges in clay, scanned with noise from a place that is `shift_mm` off along the rows.
RangeGrid scan(double noise_mm, std::uint64_t seed, double shift_mm = 0) {
  Random random(seed);
  return test::height_field(150, 130, kSpacingMm, [&](double x, double y) {
    const double u = x + shift_mm;
    const double wedges = std::min(
        0.0, std::abs(std::remainder(u + 0.3 * y, 3.7)) + std::abs(std::remainder(y - 0.2 * u, 4.1)) - 0.9);
    const double bulge = 0.4 * std::sin(0.11 * u) * std::cos(0.13 * y + 0.02 * u * y);
    return wedges + bulge + noise_mm * random.normal();
  });
}

RigidTransform elsewhere() {
  return RigidTransform::from_twist({0.4, -0.3, 1.0}, {30, -200, 500});
}

bool is_copy(const RangeGrid& a, const RangeGrid& b) {
  const std::optional<ScanPrint> first = scan_print(a);
  const std::optional<ScanPrint> second = scan_print(b);
  EXPECT_EQ(are_copies(*first, *second), are_copies(*second, *first));
  return are_copies(*first, *second);
}

bool is_copy_in_place(const RangeGrid& a, const RangeGrid& b) {
  const auto motion = copy_motion(*scan_print(a), *scan_print(b));
  return motion && motion->row_major() == RigidTransform{}.row_major();
}

bool is_part_of(const RangeGrid& part, const RangeGrid& whole) {
  return is_part(*scan_print(part), *scan_print(whole));
}

TEST(SameMarks, AScanIsKnownAgainInAnyForm) {
  for (const double noise_mm : {0.02, 0.0}) {
    const RangeGrid grid = scan(noise_mm, 1);
    EXPECT_TRUE(is_copy(grid, rounded(grid, 0.001))) << noise_mm;
    EXPECT_TRUE(is_copy(grid, transposed(grid))) << noise_mm;
    EXPECT_TRUE(is_copy(grid, reversed(grid))) << noise_mm;
    EXPECT_TRUE(is_copy(grid, moved(grid, elsewhere()))) << noise_mm;
    EXPECT_TRUE(is_copy(grid, cropped(grid, 0.2, 0.7))) << noise_mm;
    EXPECT_TRUE(
        is_copy(grid, rounded(moved(transposed(reversed(cropped(grid, 0.1, 0.9))), elsewhere()), 0.001)))
        << noise_mm;
    EXPECT_TRUE(is_copy(rounded(moved(grid, elsewhere()), 0.001), rounded(cropped(grid, 0.2, 0.7), 0.001)))
        << noise_mm;
  }
  const RangeGrid grid = scan(0.02, 1);
  EXPECT_TRUE(is_copy(grid, rounded(grid, 0.01)));  // half the noise
}

/// As a reader may let them through.
TEST(SameMarks, SamplesThatAreNoPlacesDoNoHarm) {
  RangeGrid grid = scan(0.02, 1);
  for (std::size_t i = 0; i < grid.size(); i += 397) {
    grid.z[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
  }
  EXPECT_TRUE(is_copy(grid, rounded(transposed(grid), 0.001)));
  EXPECT_FALSE(is_copy(grid, scan(0.02, 2)));
  for (const ScanMark& mark : scan_marks(grid).marks) {
    EXPECT_TRUE(std::ranges::all_of(mark.shape, [](float v) { return std::isfinite(v); }));
  }
  RangeGrid row;
  row.allocate(1, 40);
  row.valid.assign(40, 1);
  EXPECT_THAT(scan_marks(row).marks, IsEmpty());
  EXPECT_THAT(scan_marks(RangeGrid{}).marks, IsEmpty());
}

TEST(SameMarks, TheMotionIsFound) {
  const RangeGrid grid = scan(0.02, 1);
  const RangeGrid part = moved(reversed(cropped(grid, 0.2, 0.7)), elsewhere());
  const auto motion = whole_from_part(scan_marks(grid), scan_marks(part));
  ASSERT_TRUE(motion);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, -10, 1)}) {
    EXPECT_LT((*motion * (elsewhere() * p) - p).norm(), 0.001);
  }
}

TEST(SameMarks, TwoScansFromOnePlaceHaveOtherNoise) {
  for (const double noise_mm : {0.02, 0.005}) {
    for (std::uint64_t seed = 2; seed < 6; ++seed) {
      EXPECT_FALSE(is_copy(scan(noise_mm, 1), scan(noise_mm, seed))) << noise_mm;
    }
  }
}

TEST(SameMarks, NoiseFreeScansAreOneFromOnePlaceAlone) {
  EXPECT_TRUE(is_copy(scan(0, 1), rounded(scan(0, 2), 0.001)));
  for (const double shift : {0.13, 0.37, 0.5, 1.41}) {
    EXPECT_FALSE(is_copy(scan(0, 1), scan(0, 1, shift * kSpacingMm))) << shift;
  }
}

/// Of smooth shapes without noise any two places look alike.
TEST(SameMarks, NothingStandsOutOfASmoothShape) {
  const auto ball = [](double x, double y) { return std::sqrt(400 - x * x - y * y); };
  const RangeGrid grid = test::height_field(80, 80, kSpacingMm, ball);
  EXPECT_THAT(scan_marks(grid).marks, IsEmpty());
  EXPECT_FALSE(is_copy(grid, moved(grid, elsewhere())));
  EXPECT_TRUE(is_copy(grid, grid));
}

/// To leave one out would lose the clay that it alone has.
TEST(SameMarks, PartsThatOverlapAreNoCopies) {
  for (const double noise_mm : {0.02, 0.0}) {
    const RangeGrid grid = scan(noise_mm, 1);
    EXPECT_FALSE(is_copy(cropped(grid, 0, 0.8), cropped(grid, 0.2, 1))) << noise_mm;
    EXPECT_FALSE(is_copy(cropped(grid, 0, 0.7), cropped(grid, 0.3, 1))) << noise_mm;
    const RangeGrid small = cropped(grid, 0, 0.4);
    EXPECT_FALSE(is_copy(cropped(small, 0, 0.9), cropped(small, 0.2, 1))) << noise_mm;
  }
}

/// Whichever has more samples.
TEST(SameMarks, TheMotionBetweenCopiesIsThatFromTheSecond) {
  const RangeGrid grid = scan(0.02, 1);
  const RangeGrid part = moved(reversed(cropped(grid, 0.2, 0.7)), elsewhere());
  const auto whole_motion = copy_motion(*scan_print(grid), *scan_print(part));
  const auto part_motion = copy_motion(*scan_print(part), *scan_print(grid));
  ASSERT_TRUE(whole_motion && part_motion);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, -10, 1)}) {
    EXPECT_LT((*whole_motion * (elsewhere() * p) - p).norm(), 0.001);
    EXPECT_LT((*part_motion * p - elsewhere() * p).norm(), 0.001);
  }
  EXPECT_FALSE(copy_motion(*scan_print(grid), *scan_print(scan(0.02, 2))));
}

TEST(SameMarks, APartHasMuchFewerSamples) {
  const RangeGrid grid = scan(0.02, 1);
  EXPECT_TRUE(is_part_of(cropped(grid, 0.2, 0.7), grid));
  EXPECT_FALSE(is_part_of(grid, cropped(grid, 0.2, 0.7)));
  EXPECT_FALSE(is_part_of(cropped(grid, 0.02, 0.99), grid));
}

TEST(SameMarks, CopiesInOneFrameAreToldExactly) {
  const RangeGrid grid = scan(0.02, 1);
  EXPECT_TRUE(is_copy_in_place(grid, grid));
  EXPECT_TRUE(is_copy_in_place(grid, rounded(transposed(grid), 0.001)));
  EXPECT_TRUE(is_copy_in_place(grid, rounded(reversed(cropped(grid, 0.02, 0.99)), 0.001)));
  EXPECT_TRUE(is_copy_in_place(grid, cropped(grid, 0.2, 0.7)));
  EXPECT_FALSE(is_copy_in_place(grid, moved(grid, elsewhere())));
  EXPECT_FALSE(is_copy_in_place(grid, moved(grid, RigidTransform::from_twist({0, 0, 0}, {0.05, 0, 0}))));
}

/// Whatever their ids and their order: to leave out the whole would lose clay.
TEST(KnownPrints, OfAScanAndItsPartsTheWholeCounts) {
  const RangeGrid grid = scan(0.02, 1);
  const auto part = scan_print(cropped(grid, 0, 0.6));
  const auto other_part = scan_print(transposed(cropped(grid, 0.5, 1)));
  const auto whole = scan_print(grid);
  const auto again = scan_print(rounded(grid, 0.001));
  KnownPrints known;
  known.add(3, part);
  known.add(1, other_part);
  known.add(8, std::nullopt);
  EXPECT_THAT(known.copies(), IsEmpty());
  known.add(7, again);
  EXPECT_THAT(known.copies(), ElementsAre(ScanCopy{1, 7}, ScanCopy{3, 7}));
  known.add(5, whole);
  EXPECT_THAT(known.copies(), ElementsAre(ScanCopy{1, 5}, ScanCopy{3, 5}, ScanCopy{7, 5}));
  EXPECT_THAT(known.copies_among({1, 3, 7, 20}), ElementsAre(ScanCopy{1, 7}, ScanCopy{3, 7}));
  EXPECT_THAT(known.copies_among({1, 3}), IsEmpty());
  known.add(5, scan_print(scan(0.02, 2)));
  EXPECT_THAT(known.copies(), ElementsAre(ScanCopy{1, 7}, ScanCopy{3, 7}));
  known.remove(7);
  EXPECT_THAT(known.copies(), IsEmpty());
  known.add(3, whole);
  known.clear();
  EXPECT_THAT(known.copies(), IsEmpty());
}

}  // namespace
}  // namespace dubsar
