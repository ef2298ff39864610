// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Selections of a mesh: kept, read again, refused for another surface, taken out as a part.

#include "station/selection_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/selections_json.h"
#include "tests/support/raster_mesh.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// n x n squares of 1 mm, two faces each, flat.
Mesh sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
      mesh.reliability.push_back(static_cast<float>(x) / 100);
    }
  }
  test::add_raster_faces(mesh, 0, n);
  return mesh;
}

MeshSelection faces(const std::string& name, std::vector<std::uint32_t> indices) {
  return {name, MeshElement::kFace, ranges_of(std::move(indices))};
}

TEST(MeshPart, RangesHoldTheIndicesOnce) {
  const std::vector<IndexRange> ranges = ranges_of({7, 3, 4, 4, 5, 0, 9, 8});
  EXPECT_THAT(ranges, ElementsAre(IndexRange{0, 1}, IndexRange{3, 3}, IndexRange{7, 3}));
  EXPECT_THAT(indices_of(ranges), ElementsAre(0U, 3U, 4U, 5U, 7U, 8U, 9U));
  EXPECT_EQ(count_of(ranges), 7U);
  EXPECT_TRUE(ranges_of({}).empty());
}

TEST(MeshPart, FacesComeWithTheirCornersAndWhatIsKnownOfThem) {
  const Mesh mesh = sheet(3);
  const Mesh part = part_of(mesh, faces("", {16, 17}));  // the square at 2, 2
  ASSERT_EQ(part.positions.size(), 4U);
  EXPECT_THAT(part.faces,
              ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}, std::array<std::uint32_t, 3>{1, 3, 2}));
  EXPECT_EQ(part.positions[3], Eigen::Vector3f(3, 3, 0));
  EXPECT_EQ(part.reliability[1], 0.03F);
  // Points bring the faces between them.
  const Mesh of_points = part_of(mesh, {"", MeshElement::kVertex, ranges_of({0, 1, 4, 9})});
  EXPECT_EQ(of_points.positions.size(), 4U);
  EXPECT_EQ(of_points.faces.size(), 1U);
}

TEST(MeshPart, AFaultyFaceIsLeftOut) {
  Mesh mesh = sheet(1);
  mesh.faces.push_back({0, 1, 99});
  const Mesh part = part_of(mesh, faces("", {0, 2}));
  EXPECT_EQ(part.faces.size(), 1U);
  EXPECT_EQ(part.positions.size(), 3U);
}

class SelectionStore : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  Mesh mesh_ = sheet(3);
  fs::path file_ = folder_.path() / "deep" / "tablet.selections.json";
};

TEST_F(SelectionStore, WhatIsKeptIsReadAgain) {
  ASSERT_TRUE(kept_selections(file_, mesh_)->empty()) << "no file: none";
  const std::vector<MeshSelection> some{faces("line \"3\"", {1, 2, 9}),
                                        {"rim", MeshElement::kVertex, ranges_of({0, 1})}};
  ASSERT_TRUE(keep_selections(file_, "tablet.ply", mesh_, some));
  EXPECT_EQ(*kept_selections(file_, mesh_), some);
  EXPECT_EQ(kept_selection(file_, mesh_, "rim")->ranges, some[1].ranges);
  const auto none = kept_selection(file_, mesh_, "edge");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(none.error().line(), HasSubstr("rim"));
}

TEST_F(SelectionStore, OfAnotherSurfaceTheyAreRefusedAndNotLost) {
  ASSERT_TRUE(keep_selections(file_, "tablet.ply", mesh_, {faces("one", {1})}));
  Mesh stitched_anew = mesh_;
  stitched_anew.positions[5].z() += 0.01F;
  const auto refused = kept_selections(file_, stitched_anew);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
  ASSERT_TRUE(keep_selections(file_, "tablet.ply", stitched_anew, {faces("two", {2})}));
  EXPECT_EQ(kept_selections(file_, stitched_anew)->front().name, "two");
  const auto before = kept_selections(fs::path(file_) += ".1", mesh_);
  ASSERT_TRUE(before) << before.error().line();
  EXPECT_EQ(before->front().name, "one");
}

TEST_F(SelectionStore, WhatIsNoSelectionIsOneLine) {
  fs::create_directories(file_.parent_path());
  const auto refusal = [&](const std::string& ranges) {
    std::ofstream(file_) << R"({"mesh":"m","surface_xxh128":")" << surface_digest(mesh_)
                         << R"(","selections":[{"name":"a","of":"faces","ranges":)" << ranges << "}]}";
    const auto read = kept_selections(file_, mesh_);
    return read ? std::string() : read.error().line();
  };
  EXPECT_EQ(refusal("[[0,3],[4,1]]"), "");
  EXPECT_THAT(refusal("[[0,3],[3,1]]"), HasSubstr("selections.md")) << "they touch";
  EXPECT_THAT(refusal("[[5,1],[0,1]]"), HasSubstr("selections.md")) << "not rising";
  EXPECT_THAT(refusal("[[0,0]]"), HasSubstr("selections.md")) << "empty";
  EXPECT_THAT(refusal("[[4294967295,9]]"), HasSubstr("selections.md"));
  EXPECT_THAT(refusal("[[0,4000000000]]"), HasSubstr("another surface")) << "more than there is";
  EXPECT_THAT(refusal("[7]"), HasSubstr("selections.md"));
}

TEST_F(SelectionStore, WedgesBelongWhereTheirDepthPointLies) {
  std::vector<Wedge> wedges(3);
  wedges[0].depth_point_mm = {0.1, 0.1, -0.4};
  wedges[1].depth_point_mm = {2.9, 2.8, -0.4};
  wedges[2].depth_point_mm = {50, 50, 0};  // of something else
  for (int k = 0; k < 3; ++k) {
    wedges[static_cast<std::size_t>(k)].id = k;
  }
  const auto found = selected_wedges(wedges, mesh_, faces("", {16, 17}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, 1);
}

TEST_F(SelectionStore, ASessionKeepsThemInItsAnalysis) {
  const fs::path session = folder_.path() / "s";
  fs::create_directories(session / "mesh");
  EXPECT_EQ(selections_file_of(session / "mesh" / "model.ply").filename(), "model.selections.json");
  std::ofstream(session / "session.sqlite") << "x";
  EXPECT_EQ(selections_file_of(session / "mesh" / "model.ply"), session / "analysis" / "selections.json");
}

}  // namespace
}  // namespace dubsar
