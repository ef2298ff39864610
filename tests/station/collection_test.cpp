// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The search index of a folder: kept, refreshed where something changed, made again when damaged.
#include "station/collection.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "analysis/wedge_features.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

WedgeFile tablet_of(double depth_mm, double length_mm, int count) {
  WedgeFile file;
  for (int i = 0; i < count; ++i) {
    const double x = 3.0 * i;
    Wedge w;
    w.id = i;
    w.depth_mm = depth_mm;
    w.depth_point_mm = {x, 0, -depth_mm};
    w.exit_points_mm = {Eigen::Vector3d(x + length_mm, 0, 0), Eigen::Vector3d(x - 0.3, 0.5, 0),
                        Eigen::Vector3d(x - 0.3, -0.5 - 0.01 * i, 0)};
    file.wedges.push_back(w);
  }
  return file;
}

class CollectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(at("x"));
    put("a.json", tablet_of(1.2, 4.0, 12));
    put("b.json", tablet_of(0.5, 2.0, 12));
    put("x/c.json", tablet_of(0.52, 2.05, 12));
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  void put(const char* name, const WedgeFile& file) const { ASSERT_TRUE(write_wedges(at(name), file)); }
  static constexpr std::chrono::milliseconds kSettled{40};
  static void settle() { std::this_thread::sleep_for(2 * kSettled); }
  [[nodiscard]] Result<Collection> open() const { return Collection::open(folder_.path(), kSettled); }
  [[nodiscard]] std::string nearest_to(const WedgeFile& like) const {
    const auto collection = open();
    const auto found = collection ? collection->similar_tablets(like, 10) : std::vector<SimilarTablet>{};
    return found.empty() ? "" : found.front().tablet;
  }
  [[nodiscard]] std::size_t read_anew() const {
    const auto collection = open();
    return collection ? collection->read_anew() : 99;
  }
  [[nodiscard]] std::string index_bytes() const {
    std::ostringstream bytes;
    bytes << std::ifstream(at(std::string(kSearchIndexName)), std::ios::binary).rdbuf();
    return bytes.str();
  }
  test::TemporaryFolder folder_;
};

TEST_F(CollectionTest, WhereEdgesAreSaidToEndTellsNoTwoTabletsApart) {
  WedgeFile extent = tablet_of(0.5, 2.0, 12);
  extent.exits = ExitDefinition::kExtent;
  for (Wedge& w : extent.wedges) {
    w.exit_points_surface_mm = w.exit_points_mm;
    w.exit_points_mm[0].x() -= 0.5;
  }
  put("extent.json", extent);
  const auto like = read_compared_wedges(at("extent.json"));
  ASSERT_TRUE(like);
  const auto collection = open();
  ASSERT_TRUE(collection);
  std::vector<std::string> names;
  for (const SimilarTablet& one : collection->similar_tablets(*like, 10)) {
    names.push_back(one.tablet);
  }
  EXPECT_THAT(names, ElementsAre("x/c.json", "a.json")) << "b.json is the same tablet";
}

TEST_F(CollectionTest, OnlyWhatChangedIsReadAgain) {
  settle();
  EXPECT_EQ(read_anew(), 3U);
  const std::string kept = index_bytes();
  EXPECT_FALSE(kept.empty());
  EXPECT_EQ(read_anew(), 0U);
  EXPECT_EQ(index_bytes(), kept);
  EXPECT_EQ(nearest_to(tablet_of(0.53, 2.06, 12)), "x/c.json");

  // One rewritten, one taken away, one more: the answers follow.
  put("a.json", tablet_of(0.53, 2.06, 13));
  fs::remove(at("x/c.json"));
  put("d.json", tablet_of(2.2, 7.0, 12));
  settle();
  EXPECT_EQ(read_anew(), 2U);
  EXPECT_EQ(read_anew(), 0U);
  EXPECT_EQ(nearest_to(tablet_of(0.53, 2.06, 12)), "a.json");
  EXPECT_EQ(nearest_to(tablet_of(2.1, 7.1, 12)), "d.json");

  // Of the same size, its time of change put back: the time of its status tells.
  struct stat before {};
  ASSERT_EQ(::stat(at("b.json").c_str(), &before), 0);
  put("b.json", tablet_of(0.9, 9.0, 12));
  const std::array<timespec, 2> times = {before.st_atim, before.st_mtim};
  ASSERT_EQ(::utimensat(AT_FDCWD, at("b.json").c_str(), times.data(), 0), 0);
  settle();
  EXPECT_EQ(nearest_to(tablet_of(0.9, 9.1, 12)), "b.json");
}

TEST_F(CollectionTest, HowItsWedgesWereMeasuredIsKeptOfEachTablet) {
  const auto put_measured = [this](const char* name, int method) {
    WedgeFile file = tablet_of(0.5, 2.0, 6);
    file.method = method;
    put(name, file);
  };
  put_measured("a.json", 3);
  put_measured("b.json", 5);
  put_measured("x/c.json", 0);  // as files of before methods were counted
  WedgeFile none;
  none.method = 4;
  put("none.json", none);
  settle();
  for (const std::size_t read : {4U, 0U}) {
    const auto collection = open();
    ASSERT_TRUE(collection);
    EXPECT_EQ(collection->read_anew(), read);
    const OtherMethods otherwise = collection->measured_otherwise(5);
    EXPECT_EQ(otherwise.searched, 3U) << "without wedges there is nothing to compare";
    EXPECT_EQ(otherwise.others, 2U);
    ASSERT_NE(otherwise.first, nullptr);
    EXPECT_EQ(otherwise.first->name, "a.json");
    EXPECT_EQ(otherwise.first->method, 3);
  }
  put_measured("a.json", 5);
  put_measured("x/c.json", 5);
  const auto collection = open();
  ASSERT_TRUE(collection);
  EXPECT_EQ(collection->measured_otherwise(5).first, nullptr);
  EXPECT_EQ(collection->measured_otherwise(5).others, 0U);
}

TEST_F(CollectionTest, AnIndexThatIsDamagedOrForeignIsMadeAgain) {
  settle();
  EXPECT_EQ(read_anew(), 3U);
  const std::string kept = index_bytes();
  for (const std::string& bytes : {std::string(), std::string("nonsense"), kept.substr(0, kept.size() / 2)}) {
    std::ofstream(at(std::string(kSearchIndexName)), std::ios::binary) << bytes;
    const auto collection = open();
    ASSERT_TRUE(collection);
    EXPECT_EQ(collection->read_anew(), 3U);
    EXPECT_THAT(collection->remark(), HasSubstr("it is made again"));
    EXPECT_EQ(index_bytes(), kept);
  }
  // In a copy of the folder nothing of it is believed.
  const test::TemporaryFolder copy;
  fs::copy(folder_.path(), copy.path(), fs::copy_options::recursive);
  settle();
  const auto copied = Collection::open(copy.path(), kSettled);
  ASSERT_TRUE(copied);
  EXPECT_EQ(copied->read_anew(), 3U);
}

TEST_F(CollectionTest, AnIndexThatCannotBeKeptCostsTimeAlone) {
  fs::create_directory(at(std::string(kSearchIndexName)));
  for (int turn = 0; turn < 2; ++turn) {
    const auto collection = open();
    ASSERT_TRUE(collection);
    EXPECT_EQ(collection->read_anew(), 3U);
    EXPECT_THAT(collection->remark(), HasSubstr("the search index is not kept"));
    EXPECT_EQ(collection->similar_tablets(tablet_of(0.53, 2.06, 12), 1).size(), 1U);
  }
}

TEST_F(CollectionTest, ASessionOrPackageIsLeftWithoutAnIndexWhereverInItOneLooks) {
  for (const char* made_by : {"session.sqlite", "bagit.txt"}) {
    std::ofstream(at(made_by)) << "what makes a folder one";
    for (const fs::path& folder : {at(""), at("x"), folder_.path()}) {
      const auto collection = Collection::open(folder, kSettled);
      ASSERT_TRUE(collection);
      EXPECT_EQ(collection->remark(), "");
      EXPECT_EQ(collection->similar_tablets(tablet_of(0.53, 2.06, 12), 1).size(), 1U);
      EXPECT_FALSE(fs::exists(folder / kSearchIndexName)) << folder;
    }
    fs::remove(at(made_by));
  }
}

TEST_F(CollectionTest, WhatNeverWasAWedgesJsonIsToldApartFromADamagedOne) {
  const std::vector<std::pair<const char*, const char*>> others{
      {"list.json", "[1, 2]"}, {"note.json", "{}"}, {"run.json", R"({"wedges": "41"})"}};
  for (const auto& [name, text] : others) {
    std::ofstream(at(name)) << text;
  }
  std::ofstream(at("cut.json")) << R"({"unit": "mm", "wed)";
  std::ofstream(at("odd.json")) << R"({"unit": "mm", "wedges": [{"id": 3}]})";
  std::ofstream(at("marked.json")) << "\xEF\xBB\xBF"
                                   << R"({"unit": "mm", "wedges": [{"id": 3}]})";
  settle();
  for (int turn = 0; turn < 2; ++turn) {
    const auto collection = open();
    ASSERT_TRUE(collection);
    EXPECT_EQ(collection->read_anew(), turn == 0 ? 9U : 0U);
    for (const IndexedTablet& file : collection->files()) {
      const bool other = std::ranges::any_of(others, [&](const auto& o) { return o.first == file.name; });
      EXPECT_EQ(file.complaint == kNoWedgesJson, other) << file.name << ": " << file.complaint;
      if (file.name == "cut.json" || file.name == "odd.json" || file.name == "marked.json") {
        EXPECT_THAT(file.complaint, HasSubstr(file.name));
      }
    }
  }
}

TEST_F(CollectionTest, LengthsBeyondTheMeshAreThoseThatDepthAndSlopeSay) {
  const auto broken = [](double length_mm) {
    WedgeFile file = tablet_of(0.5, 2.0, 12);
    for (Wedge& wedge : file.wedges) {
      wedge.beyond_mesh[0] = true;
      wedge.edge_slopes_rad[0] = std::asin(0.5 / length_mm);
    }
    file.profiles = make_profiles(file.wedges);  // which know no such length
    return file;
  };
  WedgeFile whole = tablet_of(0.5, 2.0, 12);
  for (Wedge& wedge : whole.wedges) {
    wedge.edge_slopes_rad[0] = std::asin(0.25);
  }
  put("a.json", broken(2.0));
  put("b.json", broken(6.0));
  put("x/c.json", whole);
  const auto collection = open();
  ASSERT_TRUE(collection);
  WedgeFile like = broken(2.02);
  like.wedges[0].depth_point_mm.y() = 0.01;  // no copy of a.json
  const std::vector<SimilarTablet> found = collection->similar_tablets(like, 10);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].tablet, "a.json");
  EXPECT_EQ(found[1].tablet, "x/c.json");
  EXPECT_LT(found[1].distance, 0.1);
  EXPECT_EQ(found[2].tablet, "b.json");
  EXPECT_GT(found[2].distance, 0.4);
}

TEST_F(CollectionTest, OfATabletWithoutWedgesNoneIsLike) {
  const auto collection = open();
  ASSERT_TRUE(collection);
  EXPECT_TRUE(collection->similar_tablets(WedgeFile(), 10).empty());
}

TEST_F(CollectionTest, MeasuresBeyondAllBoundsAreToldApart) {
  WedgeFile file = tablet_of(0.5, 2.0, 12);
  file.wedges[3].exit_points_mm[0] = Eigen::Vector3d(1e200, 1e200, 0);
  put("b.json", file);
  const auto collection = open();
  ASSERT_TRUE(collection);
  EXPECT_THAT(collection->files()[1].complaint, HasSubstr("beyond all bounds"));
  EXPECT_THAT(collection->files()[0].complaint, IsEmpty());
  // Nor is any order of others by how far they are from it.
  const Result<WedgeFile> like = read_compared_wedges(at("b.json"));
  ASSERT_FALSE(like);
  EXPECT_EQ(like.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(like.error().line(), HasSubstr("beyond all bounds"));
  EXPECT_TRUE(read_compared_wedges(at("a.json")));
}

}  // namespace
}  // namespace dubsar
