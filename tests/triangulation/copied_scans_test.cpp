// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scan that came twice is one measurement.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/other_forms.h"
#include "tests/triangulation/support/ball_scans.h"

namespace dubsar {
namespace {

using test::ball;
using test::expect_same;
using test::stitched;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

PlacedScan with_id(PlacedScan scan, int id) {
  scan.id = id;
  return scan;
}

TEST(CopiedScans, EveryScanTwiceIsAsEveryScanOnce) {
  const test::ScanSet once = ball();
  test::ScanSet set = ball();
  for (int k = 0; k < 6; ++k) {
    set.placed.push_back(with_id(set.placed[static_cast<std::size_t>(k)], 10 + k));
  }
  expect_same(stitched(set), stitched(once));
}

TEST(CopiedScans, ACopyElsewhereIsNoMoreEvidence) {
  const test::ScanSet once = ball();
  test::ScanSet set = ball();
  PlacedScan off = with_id(set.placed[2], 9);
  off.model_from_scanner.translation_mm += Eigen::Vector3d(0.02, 0.01, -0.01);
  set.placed.push_back(off);
  expect_same(stitched(set), stitched(once));
}

TEST(CopiedScans, WhatElseIsToldOfACopyMakesItNoOther) {
  const test::ScanSet once = ball();
  test::ScanSet set = ball();
  RangeGrid again = set.grids[1];
  again.source = "again.ply";
  again.timestamp_ns = 5;
  again.confidence.assign(again.size(), 0.5F);
  for (std::size_t i = 0; i < again.size(); ++i) {
    again.x[i] = again.valid[i] != 0 ? again.x[i] : 7.0F;  // means nothing there
  }
  set.add(std::move(again), set.placed[1].model_from_scanner);
  expect_same(stitched(set), stitched(once));
}

/// Averaged as if it were evidence of its own, its noise would count twice.
TEST(CopiedScans, ACopyInAnotherFormIsNoMoreEvidence) {
  const test::ScanSet once = ball();
  test::ScanSet set = ball();
  const RigidTransform moved = RigidTransform::from_twist({0.3, -0.2, 0.5}, {10, 20, -300});
  set.add(test::rounded(test::transposed(set.grids[1]), 0.001), set.placed[1].model_from_scanner);
  set.add(test::moved(set.grids[2], moved), set.placed[2].model_from_scanner * moved.inverse());
  set.add(test::reversed(test::cropped(set.grids[3], 0.1, 0.9)), set.placed[3].model_from_scanner);
  expect_same(stitched(set), stitched(once));
}

/// It goes as soon as the whole comes, and comes in when that is taken out.
TEST(CopiedScans, APartOfAScanIsNoMoreEvidence) {
  test::ScanSet set = ball();
  PlacedScan whole = with_id(set.placed[1], 8);
  set.grids.push_back(test::cropped(set.grids[1], 0.1, 0.9));
  set.flags.push_back(test::sparse_flags(set.grids.back()));
  set.placed[1].grid = &set.grids.back();
  set.placed[1].flags = &set.flags.back();
  const JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed, job));
  const Mesh of_the_part = stitched(set);
  EXPECT_THAT(stitcher.copies(), IsEmpty());
  ASSERT_TRUE(stitcher.add(whole, job));
  EXPECT_THAT(stitcher.copies(), ElementsAre(ScanCopy{1, 8}));
  test::ScanSet of_the_whole = ball();
  of_the_whole.placed[1].id = 8;
  expect_same(stitcher.mesh(), stitched(of_the_whole));
  EXPECT_TRUE(stitcher.remove(8));
  EXPECT_THAT(stitcher.copies(), IsEmpty());
  expect_same(stitcher.mesh(), of_the_part);
}

TEST(CopiedScans, OtherNoiseMakesAnotherScan) {
  test::ScanSet set = ball();
  set.add(test::ball_grid(0.15, 0.01, 77), set.placed[1].model_from_scanner);
  const JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed, job));
  EXPECT_THAT(stitcher.copies(), IsEmpty());
}

/// Whichever came first or was taken out meanwhile: the mesh is that of what is held.
TEST(CopiedScans, TheFirstTakenOutBringsTheEvidenceOfItsCopyBack) {
  test::ScanSet set = ball();
  const JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(with_id(set.placed[2], 8), job));
  ASSERT_TRUE(stitcher.add(with_id(set.placed[2], 7), job));
  ASSERT_TRUE(stitcher.add(set.placed, job));
  EXPECT_THAT(stitcher.copies(), ElementsAre(ScanCopy{7, 2}, ScanCopy{8, 2}));
  for (const Stitcher::Overlap& overlap : stitcher.overlaps()) {
    EXPECT_LT(overlap.other_id, 6);
  }
  const Mesh all = stitched(set);
  expect_same(stitcher.mesh(), all);

  EXPECT_TRUE(stitcher.remove(2));
  EXPECT_THAT(stitcher.copies(), ElementsAre(ScanCopy{8, 7}));
  test::ScanSet renamed = ball();
  renamed.placed[2].id = 7;
  const Mesh of_the_copy = stitched(renamed);
  expect_same(stitcher.mesh(), of_the_copy);

  EXPECT_TRUE(stitcher.remove(8));
  EXPECT_FALSE(stitcher.remove(8));
  EXPECT_THAT(stitcher.copies(), IsEmpty());
  expect_same(stitcher.mesh(), of_the_copy);

  ASSERT_TRUE(stitcher.add(set.placed[2], job));
  EXPECT_EQ(stitcher.add(with_id(set.placed[2], 7), job).error().kind, ErrorKind::kUsage);
  expect_same(stitcher.take_mesh(job).value(), all);
  EXPECT_THAT(stitcher.copies(), IsEmpty());
}

TEST(CopiedScans, ScansWithoutASampleAreNoCopies) {
  RangeGrid empty;
  empty.allocate(20, 20);
  empty.spacing_mm = 0.1;
  test::ScanSet set;
  set.add(empty, {});
  set.add(empty, {});
  const JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed, job));
  EXPECT_THAT(stitcher.copies(), IsEmpty());
}

}  // namespace
}  // namespace dubsar
