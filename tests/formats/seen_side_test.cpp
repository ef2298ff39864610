// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/seen_side.h"

#include <Eigen/Geometry>
#include <filesystem>

#include "core/units.h"
#include "formats/grid_ply.h"
#include "formats/grid_reader.h"
#include "tests/formats/format_support.h"
#include "tests/support/height_field.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::line_of;

/// A pebble in an empty field, seen from +z.
RangeGrid pebble() {
  RangeGrid grid = test::height_field(160, 200, 0.2, [](double x, double y) {
    return 8 * std::sqrt(std::max(0.0, 1 - x * x / 225 - y * y / 196));
  });
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = grid.z[i] > 0.5F ? 1 : 0;
  }
  return grid;
}

RangeGrid moved(RangeGrid grid, const Eigen::Vector3f& scale, const Eigen::Vector3f& by_mm = {0, 0, 0}) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] = scale.x() * grid.x[i] + by_mm.x();
    grid.y[i] = scale.y() * grid.y[i] + by_mm.y();
    grid.z[i] = scale.z() * grid.z[i] + by_mm.z();
  }
  return grid;
}

/// The grid as a file that does not say where it was seen from.
struct Read {
  RangeGrid grid;
  std::string remark;
};
Read read_without_direction(const RangeGrid& grid) {
  std::string text = encode_grid_ply(grid);
  const std::size_t at = text.find("obj_info dubsar_direction");
  text.erase(at, text.find('\n', at) + 1 - at);
  Read out;
  const auto scans = read_scan_bytes(
      text, "a.ply",
      {.remark = [&](const std::string&, const std::string& remark) { out.remark += remark; }});
  EXPECT_TRUE(scans) << line_of(scans);
  out.grid = scans ? std::get<RangeGrid>(scans->front()) : RangeGrid{};
  return out;
}

const Eigen::Vector3d kDown(0, 0, -1);

TEST(SeenSide, AScanThatLooksDownIsReadAsBefore) {
  const Read read = read_without_direction(pebble());
  EXPECT_EQ(read.grid.view.direction, kDown);
  EXPECT_THAT(read.remark, IsEmpty());
}

TEST(SeenSide, ProfilesInTheOtherOrderChangeNothing) {
  const Read read = read_without_direction(moved(pebble(), {1, -1, 1}));
  EXPECT_EQ(read.grid.view.direction, kDown);
  EXPECT_THAT(read.remark, IsEmpty());
}

TEST(SeenSide, ZThatPointsAwayFromTheCameraIsTakenSoAndTold) {
  const Read read = read_without_direction(moved(pebble(), {1, -1, -1}, {0, 0, 300}));
  EXPECT_EQ(read.grid.view.direction, -kDown);
  EXPECT_THAT(read.remark, HasSubstr("was seen along 0 0 1"));
  EXPECT_THAT(read.remark, HasSubstr("`obj_info dubsar_direction 0 0 -1`"));
}

TEST(SeenSide, AWordInTheHeaderIsNotDoubted) {
  const auto scans = read_scan_bytes(encode_grid_ply(moved(pebble(), {1, -1, -1}, {0, 0, 300})), "a.ply");
  ASSERT_TRUE(scans);
  EXPECT_EQ(std::get<RangeGrid>(scans->front()).view.direction, kDown);
}

TEST(SeenSide, DepthThatMirrorsIsToldAndNotGuessed) {
  const Read read = read_without_direction(moved(pebble(), {1, 1, -1}));
  EXPECT_EQ(read.grid.view.direction, kDown);
  EXPECT_THAT(read.remark, HasSubstr("its outline rises towards the scanner"));
  EXPECT_THAT(read.remark, HasSubstr("export z negated"));
}

TEST(SeenSide, AFieldThatIsFullTellsOfItsDoubt) {
  const RangeGrid full = test::height_field(40, 40, 0.2, [](double x, double y) { return 0.1 * x * y / 9; });
  EXPECT_THAT(read_without_direction(full).remark, IsEmpty());
  const Read turned = read_without_direction(moved(full, {1, -1, -1}));
  EXPECT_EQ(turned.grid.view.direction, kDown);
  EXPECT_THAT(turned.remark, HasSubstr("no outline settles it"));
}

TEST(SeenSide, TheAxisIsFoundWhereNothingIsKnown) {
  RangeGrid grid = pebble();
  for (const auto& [scale, direction] : {std::pair{Eigen::Vector3f(1, 1, 1), kDown},
                                         {Eigen::Vector3f(1, -1, -1), Eigen::Vector3d(-kDown)},
                                         {Eigen::Vector3f(1, -1, 1), kDown}}) {
    RangeGrid other = moved(grid, scale);
    ASSERT_TRUE(find_direction(other, "a"));
    EXPECT_EQ(other.view.direction, direction);
  }
  std::swap(grid.x, grid.z);  // seen from +x
  ASSERT_TRUE(find_direction(grid, "a"));
  EXPECT_EQ(grid.view.direction, Eigen::Vector3d(-1, 0, 0));
  RangeGrid full = test::height_field(40, 40, 0.2, [](double, double) { return 0.0; });
  EXPECT_THAT(line_of(find_direction(full, "a.ptx")), HasSubstr("a.ptx: the scanner's position 0 0 0"));
}

RangeGrid turned(RangeGrid grid, const Eigen::Matrix3d& turn) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector3f p = (turn * grid.point(i).cast<double>()).cast<float>();
    grid.x[i] = p.x();
    grid.y[i] = p.y();
    grid.z[i] = p.z();
  }
  return grid;
}

TEST(SeenSide, AScanInAFrameThatIsNotTheScannersIsReadAlongItsOwnAxis) {
  for (const double deg : {30.0, 75.0, 100.0, 160.0}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
    for (const float order : {1.0F, -1.0F}) {  // profiles in the other order
      const Read read = read_without_direction(turned(moved(pebble(), {1, order, 1}), turn));
      EXPECT_LT(deg_from_rad(std::acos(std::min(1.0, read.grid.view.direction.dot(turn * kDown)))), 1.0)
          << deg;
      EXPECT_THAT(read.remark, HasSubstr("its frame is not the scanner's"));
      EXPECT_NEAR(read.grid.spacing_mm, 0.2, 0.02);
    }
  }
}

TEST(SeenSide, AFullFieldInAnotherFrameTellsThatItsSideIsOpen) {
  const RangeGrid full = test::height_field(80, 80, 0.2, [](double x, double y) { return 0.03 * x * y; });
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  const Read read = read_without_direction(turned(full, turn));
  EXPECT_GT(read.grid.view.direction.dot(turn * kDown), 0.99);
  EXPECT_THAT(read.remark, HasSubstr("though no outline settles from which side"));
}

TEST(SeenSide, UnevenProfilesOfAFlatFaceDoNotTurnIt) {
  RangeGrid flat = test::height_field(80, 80, 0.2, [](double x, double y) { return 0.1 * std::sin(x) * y; });
  for (std::size_t i = 0; i < flat.size(); ++i) {
    flat.y[i] += static_cast<float>(1.5 * std::sin(0.05 * flat.row_of(i)));
  }
  const Read read = read_without_direction(flat);
  EXPECT_EQ(read.grid.view.direction, kDown);
  EXPECT_THAT(read.remark, IsEmpty());
}

TEST(SeenSide, RealScansAreReadAsBefore) {
  int scans = 0;
  for (const char* name : {"stanford_bunny", "stanford_dragon_stand"}) {
    const auto folder = test::real_data() / name;
    if (!std::filesystem::exists(folder)) {
      GTEST_SKIP() << "no real scans beside the project";
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (!looks_like_scan(entry.path())) {
        continue;
      }
      std::string told;
      const auto read = read_scan_file(
          entry.path(), {.mm_per_unit = 1000.0,
                         .remark = [&](const std::string&, const std::string& remark) { told += remark; }});
      ASSERT_TRUE(read) << line_of(read);
      RangeGrid grid = std::get<RangeGrid>(read->front());
      EXPECT_EQ(grid.view.direction, kDown) << entry.path();
      EXPECT_THAT(told, IsEmpty()) << entry.path();
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(rad_from_deg(70 + 5 * scans), Eigen::Vector3d(1, 2, 0.5).normalized())
              .toRotationMatrix();
      RangeGrid elsewhere = turned(grid, turn);
      EXPECT_THAT(settle_direction(elsewhere), ::testing::Not(IsEmpty())) << entry.path();
      // The dragon's columns follow its camera's rays, 28 degrees from the laser's.
      EXPECT_LT(deg_from_rad(std::acos(elsewhere.view.direction.dot(turn * kDown))), 30.0) << entry.path();
      // The same with its z away from the camera.
      for (std::vector<float>* axis : {&grid.y, &grid.z}) {
        for (float& value : *axis) {
          value = -value;
        }
      }
      EXPECT_THAT(settle_direction(grid), HasSubstr("was seen along 0 0 1")) << entry.path();
      EXPECT_EQ(grid.view.direction, -kDown) << entry.path();
      ++scans;
    }
  }
  EXPECT_EQ(scans, 25);
}

}  // namespace
}  // namespace dubsar
