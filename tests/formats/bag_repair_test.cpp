// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bag_repair.h"

#include <gmock/gmock.h>

#include "tests/formats/support/small_bag.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr const char* kPicture = "data/rückseite 100%.png";

class BagRepairTest : public test::SmallBag {
 protected:
  void SetUp() override {
    test::SmallBag::SetUp();
    fs::copy(bag(), copy(), fs::copy_options::recursive);
  }
  [[nodiscard]] fs::path copy() const { return temporary_.path() / "copy"; }
  [[nodiscard]] fs::path aside() const { return temporary_.path() / "bag.damaged-1"; }
  Result<BagRepair> repair() { return repair_bag(bag(), check(), copy(), job_); }
  static std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(BagRepairTest, WhatIsDamagedAndMissingComesBackAndTheDamagedIsKept) {
  put("data/master.ply", "ply and so on?");
  fs::remove(bag() / kPicture);
  fs::remove(bag() / "bagit.txt");
  const Result<BagRepair> done = repair();
  ASSERT_TRUE(done) << done.error().line();
  EXPECT_THAT(done->restored, UnorderedElementsAre("data/master.ply", kPicture, "bagit.txt"));
  EXPECT_TRUE(check().ok());
  EXPECT_EQ(done->set_aside, fs::weakly_canonical(aside()));
  EXPECT_EQ(text_of(aside() / "data/master.ply"), "ply and so on?");
}

TEST_F(BagRepairTest, TwoCopiesThatAreDamagedInDifferentPlacesMakeAWholeOne) {
  put("data/master.ply", "damaged here");
  std::ofstream(copy() / kPicture) << "damaged there";
  ASSERT_TRUE(repair());
  EXPECT_TRUE(check().ok());
}

TEST_F(BagRepairTest, OfADamagedListTheListComesBackAndNothingElse) {
  for (const char* name : {"manifest-sha512.txt", "tagmanifest-sha512.txt"}) {
    std::string text = text_of(bag() / name);
    text.front() = text.front() == '0' ? '1' : '0';
    put(name, text);
    const Result<BagRepair> done = repair();
    ASSERT_TRUE(done) << done.error().line();
    EXPECT_THAT(done->restored, ElementsAre(name));
    EXPECT_TRUE(check().ok());
  }
}

TEST_F(BagRepairTest, NothingIsWrittenThroughALinkInABag) {
  const fs::path elsewhere = temporary_.path() / "elsewhere";
  fs::rename(bag() / "data", elsewhere);
  std::ofstream(elsewhere / "master.ply") << "somebody else's";
  fs::create_directory_symlink(elsewhere, bag() / "data");
  const Result<BagRepair> done = repair();
  ASSERT_TRUE(done) << done.error().line();
  EXPECT_TRUE(check().ok());
  EXPECT_EQ(text_of(elsewhere / "master.ply"), "somebody else's");
}

TEST_F(BagRepairTest, NothingIsTakenThatTheCopyHasDamagedOrOfAnotherPackage) {
  put("data/master.ply", "damaged here");
  std::ofstream(copy() / "data/master.ply") << "damaged there";
  const Result<BagRepair> none = repair();
  ASSERT_TRUE(none) << none.error().line();
  EXPECT_TRUE(none->restored.empty());
  EXPECT_FALSE(none->set_aside);
  EXPECT_EQ(text_of(bag() / "data/master.ply"), "damaged here");

  fs::remove_all(copy());
  fs::create_directories(copy() / "data");
  std::ofstream(copy() / "bagit.txt") << "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n";
  std::ofstream(copy() / "manifest-sha512.txt") << "";
  EXPECT_THAT(repair().error().line(), HasSubstr("of another package"));
}

}  // namespace
}  // namespace dubsar
