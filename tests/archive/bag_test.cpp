// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/sha2.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::put;
using test::text_of_file;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Bag, HasTheTagFilesOfTheStandard) {
  const test::TemporaryFolder folder;
  put(folder.path() / "data" / "b.txt", "bb");
  put(folder.path() / "data" / "a" / "one.bin", std::string(3, '\0'));
  const auto size =
      write_bag_tags(folder.path(), {{"Source-Organization", "A\r\nB"}, {"Contact-Name", ""}}, JobContext());
  ASSERT_TRUE(size) << size.error().line();
  EXPECT_EQ(size->files, 2U);
  EXPECT_EQ(size->bytes, 5U);
  EXPECT_EQ(text_of_file(folder.path() / "bagit.txt"),
            "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n");
  EXPECT_EQ(text_of_file(folder.path() / "bag-info.txt"),
            "Source-Organization: A  B\nBag-Size: 5 bytes\nPayload-Oxum: 5.2\n");
  EXPECT_EQ(text_of_file(folder.path() / "manifest-sha512.txt"),
            sha512_hex(std::string(3, '\0')) + "  data/a/one.bin\n" + sha512_hex("bb") + "  data/b.txt\n");
  const std::string tags = text_of_file(folder.path() / "tagmanifest-sha512.txt");
  for (const char* tag : {"bagit.txt", "bag-info.txt", "manifest-sha512.txt"}) {
    EXPECT_THAT(tags, HasSubstr(sha512_hex(text_of_file(folder.path() / tag)) + "  " + tag + "\n"));
  }
  EXPECT_THAT(tags, Not(HasSubstr("data/")));
}

TEST(Bag, EncodesWhatALineCannotHold) {
  EXPECT_EQ(bag_path("data/100 %\n\r.txt"), "data/100 %25%0A%0D.txt");
  EXPECT_EQ(bag_path("data/Ḫattuša.ply"), "data/Ḫattuša.ply");
}

TEST(Bag, RefusesWhatIsNoPayload) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder.path() / "data");
  EXPECT_EQ(write_bag_tags(folder.path(), {}, JobContext()).error().kind, ErrorKind::kBadInput);
  fs::create_symlink("/etc/hostname", folder.path() / "data" / "link");
  EXPECT_EQ(write_bag_tags(folder.path(), {}, JobContext()).error().kind, ErrorKind::kBadInput);
}

TEST(Bag, RefusesWhatIsNeitherFileNorFolder) {
  for (const char* to : {"elsewhere", "b.txt", "link"}) {  // in vain, to a file, to itself
    const test::TemporaryFolder folder;
    put(folder.path() / "data" / "b.txt", "b");
    fs::create_symlink(to, folder.path() / "data" / "link");
    const auto size = write_bag_tags(folder.path(), {}, {});
    ASSERT_FALSE(size) << to;
    EXPECT_EQ(size.error().kind, ErrorKind::kBadInput) << to;
    EXPECT_EQ(size.error().where, (folder.path() / "data/link").string()) << to;
  }
}

TEST(Bag, StopsWhenAsked) {
  const test::TemporaryFolder folder;
  put(folder.path() / "data" / "a", "a");
  JobContext stopped;
  stopped.cancel();
  EXPECT_EQ(write_bag_tags(folder.path(), {}, stopped).error().kind, ErrorKind::kCancelled);
  EXPECT_FALSE(fs::exists(folder.path() / "bagit.txt"));
}

}  // namespace
}  // namespace dubsar
