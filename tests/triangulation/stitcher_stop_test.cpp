// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A stitcher that is stopped ends soon, and goes on afterwards as if nothing had been.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/triangulation/support/ball_scans.h"
#include "triangulation/fusion.h"
#include "triangulation/pairing.h"
#include "triangulation/stitch_entry.h"

namespace dubsar {
namespace {

using test::ball;
using test::expect_same;
using test::stitched;

constexpr double kCoarse_mm = 0.4;

/// A job that is cancelled when it reports for the n-th time, counted from 0.
class StoppedJob {
 public:
  explicit StoppedJob(std::size_t report) : report_(report) {}

  [[nodiscard]] const JobContext& context() const { return job_; }
  /// How often it has reported.
  [[nodiscard]] std::size_t reports() const { return reports_; }

 private:
  std::size_t report_;
  std::size_t reports_ = 0;
  JobContext job_{[this](std::string_view, double) {
    if (reports_++ == report_) {
      job_.cancel();
    }
  }};
};

/// The same ball three times, as measured at other times.
test::ScanSet eighteen_scans() {
  test::ScanSet set;
  for (std::uint64_t seed = 1; seed <= 18; ++seed) {
    set.add(test::ball_grid(kCoarse_mm, 0.01, seed), test::view_from(static_cast<int>(seed % 6)), 0.01);
  }
  return set;
}

TEST(StitcherStop, OfManyThatAreAddedNoneIsInAndAllMayComeAgain) {
  const test::ScanSet set = eighteen_scans();
  Stitcher stitcher;
  const StoppedJob stopped(0);
  const Status added = stitcher.add(set.placed, stopped.context());
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(stitcher.mesh().faces.empty());
  EXPECT_FALSE(stitcher.remove(0));
  const JobContext job;
  ASSERT_TRUE(stitcher.add(set.placed, job));
  expect_same(stitcher.mesh(), stitched(set));
}

/// Twice the same id in one list is seen before anything is done.
TEST(StitcherStop, OfTwoWithOneIdTheFirstIsIn) {
  test::ScanSet set = ball(kCoarse_mm);
  set.placed[3].id = 1;
  Stitcher stitcher;
  EXPECT_EQ(stitcher.add(set.placed, JobContext()).error().kind, ErrorKind::kUsage);
  set.placed.resize(3);
  expect_same(stitcher.mesh(), stitched(set));
}

TEST(StitcherStop, WhereverAMeshIsStoppedTheNextIsWhole) {
  const test::ScanSet set = ball(kCoarse_mm);
  const Mesh whole = stitched(set);
  ASSERT_FALSE(whole.faces.empty());
  const auto filled = [&] {
    Stitcher stitcher;
    EXPECT_TRUE(stitcher.add(set.placed, JobContext()));
    return stitcher;
  };
  const StoppedJob never(std::numeric_limits<std::size_t>::max());
  ASSERT_TRUE(filled().mesh(never.context()));
  ASSERT_GT(never.reports(), 30U);
  for (std::size_t report = 0; report + 1 < never.reports(); ++report) {
    SCOPED_TRACE(report);
    const Stitcher stitcher = filled();
    const StoppedJob stopped(report);
    const Result<Mesh> mesh = stitcher.mesh(stopped.context());
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(stopped.reports(), report + 1);
    expect_same(stitcher.mesh(), whole);
  }
}

TEST(StitcherStop, AfterAStoppedUpdateScansComeAndGo) {
  test::ScanSet set = ball(kCoarse_mm);
  const StoppedJob never(std::numeric_limits<std::size_t>::max());
  {
    Stitcher stitcher;
    ASSERT_TRUE(stitcher.add(set.placed, JobContext()));
    ASSERT_TRUE(stitcher.update(never.context()));
  }
  for (std::size_t report = 0; report < never.reports(); ++report) {
    SCOPED_TRACE(report);
    Stitcher stitcher;
    ASSERT_TRUE(stitcher.add(set.placed, JobContext()));
    const StoppedJob stopped(report);
    EXPECT_EQ(stitcher.update(stopped.context()).error().kind, ErrorKind::kCancelled);
    EXPECT_TRUE(stitcher.remove(1));
    ASSERT_TRUE(stitcher.add(set.placed[1], JobContext()));
    expect_same(stitcher.mesh(), stitched(set));
  }
}

TEST(StitcherStop, OneThatLetsGoOfItsScansHoldsNone) {
  const test::ScanSet set = ball(kCoarse_mm);
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed, JobContext()));
  const StoppedJob stopped(15);
  EXPECT_FALSE(stitcher.take_mesh(stopped.context()));
  EXPECT_TRUE(stitcher.mesh().faces.empty());
  ASSERT_TRUE(stitcher.add(set.placed, JobContext()));
  expect_same(stitcher.mesh(), stitched(set));
}

/// However many pairs there are, whose steps are measured and which are looked for anew.
TEST(StitcherStop, PlacesAreNotWeighed) {
  const test::ScanSet set = ball(kCoarse_mm);
  const PassKey one(0, 0), two(2, 0);
  Entries entries;
  Entry& first = entries[one];
  Entry& second = entries[two];
  first.surface = make_scan_surface(set.placed[0], {});
  second.surface = make_scan_surface(set.placed[2], {});
  std::optional<FoundPairs> found = pairs_between(one, first.surface, two, second.surface, {}, JobContext());
  ASSERT_TRUE(found.has_value());
  first.steps[two] = found->step;
  first.pairs.emplace(two, std::move(found->there));
  second.pairs.emplace(one, std::move(found->back));
  JobContext stopped;
  stopped.cancel();
  EXPECT_FALSE(weigh_places(entries, stopped));
  EXPECT_TRUE(weigh_places(entries, JobContext()));
}

/// What the stages are made of asks the job, too.
TEST(StitcherStop, ScansAreNeitherTriangulatedNorPairedNorAveraged) {
  const test::ScanSet set = ball(kCoarse_mm);
  JobContext stopped;
  stopped.cancel();
  const StitchSurfaceOptions options;
  const auto none = [](const auto& values) {
    return std::ranges::all_of(values, [](auto value) { return value == 0; });
  };
  EXPECT_TRUE(none(make_scan_surface(set.placed[0], options, stopped).usable));
  const StitchSurface a = make_scan_surface(set.placed[0], options);
  const StitchSurface b = make_scan_surface(set.placed[2], options);
  EXPECT_FALSE(none(a.usable));
  const double reach_mm = pair_reach_mm(a, b, {});
  EXPECT_GT(find_pairs(a, b, reach_mm, {}).nodes, 0U);
  EXPECT_EQ(find_pairs(a, b, reach_mm, {}, stopped).nodes, 0U);

  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < a.usable.size(); ++i) {
    if (a.usable[i] != 0) {
      which.push_back(i);
    }
  }
  const std::span<const std::uint32_t> all(which);
  FusedSamples fused(a);
  fuse(a, {}, {}, all.first(10), fused);
  fuse(a, {}, {}, all.subspan(10), fused, stopped);
  EXPECT_EQ(fused.samples.size(), 10U);
  EXPECT_EQ(fused.points.size(), 10U);
  EXPECT_EQ(std::ranges::count(fused.slot, FusedSamples::kNone) + 10,
            static_cast<std::ptrdiff_t>(fused.slot.size()));
  fuse(a, {}, {}, all.subspan(10), fused);
  EXPECT_EQ(fused.samples, which);
}

}  // namespace
}  // namespace dubsar
