// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the simulator and real scanners give is known again in another form, and taken for nothing else.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "acquisition/resample.h"
#include "core/mesh_query.h"
#include "core/random.h"
#include "core/scan_copies.h"
#include "formats/grid_reader.h"
#include "sim/scanner.h"
#include "tests/support/other_forms.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::cropped;
using test::moved;
using test::reversed;
using test::rounded;
using test::transposed;

bool is_copy(const RangeGrid& a, const RangeGrid& b) {
  return are_copies(*scan_print(a), *scan_print(b));
}

RigidTransform elsewhere() {
  return RigidTransform::from_twist({0.4, -0.3, 1.0}, {30, -200, 500});
}

void expect_known_again(const RangeGrid& grid, const std::string& name) {
  EXPECT_TRUE(is_copy(grid, rounded(grid, 0.001))) << name;
  EXPECT_TRUE(is_copy(grid, rounded(transposed(grid), 0.001))) << name;
  EXPECT_TRUE(is_copy(grid, reversed(grid))) << name;
  EXPECT_TRUE(is_copy(grid, rounded(moved(grid, elsewhere()), 0.001))) << name;
  EXPECT_TRUE(is_copy(grid, rounded(cropped(grid, 0.2, 0.8), 0.001))) << name;
  EXPECT_TRUE(is_copy(grid, rounded(moved(transposed(cropped(grid, 0.1, 0.9)), elsewhere()), 0.001))) << name;
}

void expect_no_copies(const std::vector<RangeGrid>& grids) {
  KnownPrints known;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    known.add(static_cast<int>(k), scan_print(grids[k]));
  }
  for (const ScanCopy& copy : known.copies()) {
    ADD_FAILURE() << copy.id << " is no copy of " << copy.of_id;
  }
}

class OtherForms : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    sim::TabletOptions options;
    options.size_mm = {24, 18, 10};
    options.spacing_mm = 0.15;
    JobContext job;
    tablet_ = std::make_unique<sim::SimTablet>(sim::make_tablet(options, job).value());
    query_ = std::make_unique<MeshQuery>(tablet_->mesh);
  }
  static void TearDownTestSuite() {
    query_.reset();
    tablet_.reset();
  }

  /// From above, turned by so much about the tablet's x, and shifted.
  static RangeGrid scanned(double noise_mm, std::uint64_t number, double turn_rad = 0, double shift_mm = 0) {
    sim::ScannerOptions options = sim::scanner_for({24, 18, 10}, 0.12, noise_mm);
    if (noise_mm == 0) {
      options.dropout = options.outlier = options.quantum_mm = 0;
    }
    sim::Scene scene;
    scene.tablet = tablet_.get();
    scene.query = query_.get();
    const RigidTransform tablet_from_scanner =
        RigidTransform::from_twist({0.1 + turn_rad, 0.05, 0.2}, {shift_mm, 0.3 * shift_mm, 0});
    JobContext job;
    return sim::TriangulationScanner(options).scan_grid(scene, tablet_from_scanner, number, job).value();
  }

 private:
  static inline std::unique_ptr<sim::SimTablet> tablet_;
  static inline std::unique_ptr<MeshQuery> query_;
};

TEST_F(OtherForms, OfATabletAreKnown) {
  expect_known_again(scanned(0.02, 1), "noisy");
  expect_known_again(scanned(0, 1), "without noise");
}

TEST_F(OtherForms, OfATabletAsPlainPointsAreKnown) {
  for (const double noise_mm : {0.02, 0.0}) {
    const RangeGrid grid = scanned(noise_mm, 1);
    PointCloud cloud;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (grid.valid[i] != 0) {
        cloud.points.push_back(grid.point(i));
      }
    }
    Random random(3);
    for (std::size_t i = cloud.points.size(); i > 1; --i) {
      std::swap(cloud.points[i - 1], cloud.points[random.below(i)]);
    }
    JobContext job;
    const Result<RangeGrid> again = resample(cloud, {}, job);
    ASSERT_TRUE(again);
    EXPECT_TRUE(is_copy(grid, *again)) << noise_mm;
  }
}

TEST_F(OtherForms, AnotherScanOfTheTabletIsNone) {
  std::vector<RangeGrid> grids;
  for (std::uint64_t number = 1; number < 4; ++number) {
    grids.push_back(scanned(0.02, number));  // the scanner stands still
  }
  grids.push_back(scanned(0.02, 4, 0, 0.05));
  grids.push_back(scanned(0.02, 5, 0.003, 0));
  grids.push_back(scanned(0.02, 6, 0.3, 2));
  expect_no_copies(grids);
}

TEST_F(OtherForms, WithoutNoiseAScanFromOnePlaceIsOne) {
  EXPECT_TRUE(is_copy(scanned(0, 1), scanned(0, 2)));
  expect_no_copies({scanned(0, 1), scanned(0, 1, 0, 0.05), scanned(0, 1, 0.003, 0), scanned(0, 1, 0.3, 2)});
}

class OtherFormsOf : public ::testing::TestWithParam<const char*> {};

TEST_P(OtherFormsOf, RealScans) {
  const fs::path folder = test::real_data() / GetParam();
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no real scans";
  }
  std::vector<RangeGrid> grids;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".ply") {
      auto scans = read_scan_file(entry.path(), {1000.0});
      ASSERT_TRUE(scans);
      grids.push_back(std::get<RangeGrid>(std::move(scans->front())));
      expect_known_again(grids.back(), grids.back().source);
    }
  }
  EXPECT_GE(grids.size(), 10U);
  expect_no_copies(grids);
}

INSTANTIATE_TEST_SUITE_P(, OtherFormsOf, ::testing::Values("stanford_bunny", "stanford_dragon_stand"));

}  // namespace
}  // namespace dubsar
