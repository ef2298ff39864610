// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bag_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/bag_text.h"
#include "formats/self_checked.h"
#include "formats/sha2.h"
#include "tests/formats/support/small_bag.h"
#include "tests/support/files.h"
#include "tests/support/in_child.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::UnorderedElementsAre;

using BagTest = test::SmallBag;

TEST_F(BagTest, ACompleteBagIsValidAndEveryFileIsCovered) {
  ASSERT_TRUE(is_bag(bag()));
  const BagReport report = check();
  EXPECT_TRUE(report.ok()) << report.damaged.front().line();
  EXPECT_EQ(report.version, "1.0");
  EXPECT_THAT(report.algorithms, UnorderedElementsAre("sha256", "sha512"));
  EXPECT_EQ(report.whole.size(), 6U);
  EXPECT_THAT(report.unrecorded, IsEmpty());
}

TEST_F(BagTest, EveryFlippedByteIsNoticed) {
  for (const char* name :
       {"data/master.ply", "bag-info.txt", "manifest-sha512.txt", "tagmanifest-sha512.txt"}) {
    std::fstream file(bag() / name, std::ios::in | std::ios::out | std::ios::binary);
    const auto size = fs::file_size(bag() / name);
    for (std::uintmax_t at = 0; at < size; at += 1 + size / 7) {
      file.seekg(static_cast<std::streamoff>(at));
      const char was = static_cast<char>(file.get());
      file.seekp(static_cast<std::streamoff>(at));
      file.put(static_cast<char>(was ^ 1)).flush();
      EXPECT_FALSE(check().ok()) << name << " at " << at;
      file.seekp(static_cast<std::streamoff>(at));
      file.put(was).flush();
    }
  }
  EXPECT_TRUE(check().ok());
}

/// No list covers it: but its digits and names tell that what it lists is whole.
TEST_F(BagTest, AFlippedBitOfTheTagManifestIsNoFaultOfWhatItLists) {
  const std::string name = "tagmanifest-sha512.txt";
  const std::string text = test::text_of_file(bag() / name);
  int named = 0;
  for (std::size_t bit = 0; bit < 8 * text.size(); bit += 3) {
    std::string flipped = text;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    put(name, flipped);
    const BagReport report = check();
    for (const Error& error : report.damaged) {  // none where a digit became a capital
      EXPECT_EQ(error.where, name) << bit << ": " << error.line();
      EXPECT_THAT(error.what, HasSubstr("line ")) << bit;
      if (error.what.find("is damaged: ") != std::string::npos) {
        EXPECT_GE(report.whole.size(), 5U) << error.line();  // the next line may be a part of its name
        ++named;
      }
    }
  }
  EXPECT_GT(named, 300);
  put(name, text);
  put("bag-info.txt", "Payload-Oxum: 23.2\n");
  EXPECT_THAT(faults(), ElementsAre("bag-info.txt: not the bytes that tagmanifest-sha512.txt says"));
}

TEST_F(BagTest, ADamagedLineOfAManifestIsTold) {
  std::string text = test::text_of_file(bag() / "manifest-sha512.txt");
  text[5] = text[5] == '0' ? '1' : '0';
  put("manifest-sha512.txt", text);
  EXPECT_THAT(faults(), UnorderedElementsAre(
                            "manifest-sha512.txt: not the bytes that tagmanifest-sha512.txt says",
                            "manifest-sha512.txt: line 1 is damaged: of the checksum of data/master.ply "
                            "1 of 128 digits are others, and the file is whole"));
  text = line("data/mastes.ply", sum512("data/master.ply")) + text.substr(text.find('\n') + 1);
  put("manifest-sha512.txt", text);
  EXPECT_THAT(faults(), UnorderedElementsAre(
                            "manifest-sha512.txt: not the bytes that tagmanifest-sha512.txt says",
                            "manifest-sha512.txt: line 1 is damaged: it names data/mastes.ply, which is "
                            "not here, with the checksum of data/master.ply, which is whole"));
  EXPECT_THAT(check().whole, Contains("data/master.ply"));
}

/// What a file says of itself counts where nothing speaks for the list.
TEST_F(BagTest, AFilesOwnChecksumSpeaksForItUnlessTheListIsWhole) {
  const std::string said = with_own_checksum("{\"selections\":[]}");
  put("data/selections.json", said);
  fs::remove(bag() / "manifest-sha256.txt");
  const std::string others = test::text_of_file(bag() / "manifest-sha512.txt");
  put("manifest-sha512.txt", others + line("data/selections.json", std::string(128, '7')));
  put("bag-info.txt", "Source-Organization: A museum\n");
  fs::remove(bag() / "tagmanifest-sha512.txt");
  EXPECT_THAT(faults(), ElementsAre("manifest-sha512.txt: line 3 has another checksum than "
                                    "data/selections.json, whose own fits: the line is damaged, or somebody "
                                    "changed the file on purpose"));
  EXPECT_THAT(check().whole, testing::Not(Contains("data/selections.json")));
  put("tagmanifest-sha512.txt", line("manifest-sha512.txt", sum512("manifest-sha512.txt")));
  EXPECT_THAT(faults(), ElementsAre("data/selections.json: not the bytes that manifest-sha512.txt says"));
}

TEST_F(BagTest, WhereDubsarWroteItALostTagManifestIsDamage) {
  fs::remove(bag() / "tagmanifest-sha512.txt");
  EXPECT_TRUE(check().ok()) << "RFC 8493 asks for none";
  EXPECT_THAT(check().unrecorded, Contains("bag-info.txt"));
  put("bag-info.txt", "Bag-Software-Agent: Dubsar 0.1.0\nPayload-Oxum: 23.2\n");
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("tagmanifest-sha512.txt: missing")));
  list_all();
  EXPECT_TRUE(check().ok());
}

TEST_F(BagTest, MissingAndExtraFilesAreNamed) {
  fs::remove(bag() / "data/master.ply");
  put("data/stowaway.txt", "23 bytes, no: 26 of them.\n");
  put("notes.txt", "a tag file that nobody listed: allowed");
  const auto found = faults();
  EXPECT_THAT(found, Contains("data/master.ply: missing"));
  EXPECT_THAT(found, Contains("data/stowaway.txt: no manifest lists it"));
  EXPECT_THAT(found, Contains(HasSubstr("Payload-Oxum says 23 bytes in 2 files; there are 35 in 2")));
  EXPECT_EQ(found.size(), 3U);
  EXPECT_THAT(check().unrecorded, ElementsAre("notes.txt"));
  // A file too many is not mended by another copy of the bag.
  for (const Error& error : check().damaged) {
    EXPECT_EQ(error.mend.find("from its source") == std::string::npos, error.where == "data/stowaway.txt");
  }
}

TEST_F(BagTest, OneFaultIsToldOnce) {
  fs::remove(bag() / "tagmanifest-sha512.txt");
  fs::remove(bag() / "manifest-sha256.txt");
  const std::string manifest = line("data/master.ply", sum512("data/master.ply")) +
                               line("data/rückseite 100%25.png", sum512("data/rückseite 100%.png"));
  put("manifest-sha512.txt", manifest + line("data/master.ply", sum512("data/master.ply")));
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("for the second time"))) << "the manifest is there";
  put("manifest-sha512.txt", manifest);
  put("bag-info.txt", "Source-Organization: A museum\n");
  fs::rename(bag() / "data/master.ply", temporary_.path() / "master.ply");
  fs::create_symlink(temporary_.path() / "master.ply", bag() / "data/master.ply");
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("data/master.ply: a link"))) << "and not missing besides";
}

TEST_F(BagTest, EveryPayloadFileStandsInEveryManifest) {
  put("manifest-sha256.txt", line("data/master.ply", sha256_hex("ply and so on\n")));
  fs::remove(bag() / "tagmanifest-sha512.txt");
  EXPECT_THAT(faults(), ElementsAre("data/rückseite 100%.png: not every manifest lists it"));
}

TEST_F(BagTest, WhatLeadsOutOfTheBagIsRefused) {
  fs::remove(bag() / "tagmanifest-sha512.txt");
  for (const char* path : {"../secret", "data/../../secret", "/etc/passwd", "~/x", "data/%0a/../../../x"}) {
    put("manifest-sha256.txt", line(path, std::string(64, 'a')));
    EXPECT_THAT(faults(), Contains(HasSubstr("outside the bag"))) << path;
  }
  list_all();
  fs::remove(bag() / "data/master.ply");
  fs::create_symlink("/etc/passwd", bag() / "data/master.ply");
  EXPECT_THAT(faults(), Contains(HasSubstr("data/master.ply: a link")));
}

TEST_F(BagTest, DeclarationsThatAreNoneAreTold) {
  for (const char* text :
       {"", "BagIt-Version: 1.0\n", "BagIt-Version: x\nTag-File-Character-Encoding: UTF-8\n",
        "BagIt-Version: 2.0\nTag-File-Character-Encoding: UTF-8\n",
        "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-16\n",
        "\xef\xbb\xbf"
        "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"}) {
    put("bagit.txt", text);
    const BagReport report = check();
    ASSERT_FALSE(report.ok()) << text;
    EXPECT_EQ(report.damaged.front().where, "bagit.txt") << text;
    EXPECT_THAT(report.version, IsEmpty());
    EXPECT_THAT(report.whole, Contains("data/master.ply")) << text;
  }
}

TEST_F(BagTest, WhatIsWholeIsToldWithoutTheDeclaration) {
  fs::remove(bag() / "bagit.txt");
  ASSERT_TRUE(is_bag(bag()));
  put("data/master.ply", "ply and so oh\n");
  EXPECT_THAT(faults(), UnorderedElementsAre("bagit.txt: missing",
                                             "data/master.ply: not the bytes that manifest-sha256.txt says",
                                             "data/master.ply: not the bytes that manifest-sha512.txt says"));
  EXPECT_THAT(check().whole, Contains("data/rückseite 100%.png"));
}

TEST_F(BagTest, OldBagsAndUnknownSumsAreUnderstood) {
  fs::remove(bag() / "tagmanifest-sha512.txt");
  fs::remove(bag() / "manifest-sha256.txt");
  put("bagit.txt", "BagIt-Version: 0.97\r\nTag-File-Character-Encoding: UTF-8\r\n");
  put("manifest-sha512.txt", sum512("data/master.ply") + " *data/master.ply\r\n" +
                                 sum512("data/rückseite 100%.png") + " *./data/rückseite 100%.png\r\n");
  put("manifest-crc32.txt", line("data/master.ply", std::string(8, '0')));
  const BagReport report = check();
  EXPECT_TRUE(report.ok()) << report.damaged.front().line();
  EXPECT_THAT(report.unchecked, ElementsAre("manifest-crc32.txt"));
  fs::remove(bag() / "manifest-sha512.txt");
  EXPECT_THAT(faults(), Contains(HasSubstr("without a manifest of SHA-2, SHA-1 or MD5")));
}

/// As of a name that was taken from an address twice encoded.
TEST_F(BagTest, BeforeVersionOneAPercentSignStandsForItself) {
  fs::remove(bag() / "tagmanifest-sha512.txt");
  fs::remove(bag() / "manifest-sha256.txt");
  fs::rename(bag() / "data/master.ply", bag() / "data/my%2520master.ply");
  put("manifest-sha512.txt", line("data/my%2520master.ply", sum512("data/my%2520master.ply")) +
                                 line("data/rückseite 100%.png", sum512("data/rückseite 100%.png")));
  put("fetch.txt", "https://example.org/a - data/my%2520master.ply\n");
  put("bagit.txt", "BagIt-Version: 0.97\nTag-File-Character-Encoding: UTF-8\n");
  EXPECT_THAT(faults(), IsEmpty());
  put("bagit.txt", "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n");
  EXPECT_THAT(faults(), Contains("data/my%20master.ply: not here: fetch.txt says where it is"));
}

/// RFC 8493, section 3: of a valid bag every checksum of every manifest is verified.
TEST_F(BagTest, OlderSumsCountBesideBetterOnes) {
  const std::string picture = line("data/rückseite 100%25.png", digest_hex(Digest::kMd5, "a picture"));
  put("manifest-md5.txt", line("data/master.ply", digest_hex(Digest::kMd5, "ply and so on\n")) + picture);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_THAT(check().algorithms, Contains("md5"));
  put("manifest-md5.txt", line("data/master.ply", std::string(32, '0')) + picture);
  EXPECT_THAT(faults(),
              ElementsAre(MatchesRegex("manifest-md5.txt: line 1 is damaged: it has another checksum "
                                       "than data/master.ply, which is whole by manifest-sha.*")));
  put("manifest-sha1.txt", line("data/master.ply", digest_hex(Digest::kSha1, "ply and so on\n")));
  EXPECT_THAT(faults(), Contains("data/rückseite 100%.png: not every manifest lists it"));
}

/// Another copy of the bag would mend nothing.
TEST_F(BagTest, AFolderThatMayNotBeReadIsToldOnceAndItsFilesAreNotCalledMissing) {
  fs::permissions(temporary_.path(), fs::perms(0755));
  const auto told_in_child = [&](const fs::path& closed, const std::string& as) {
    fs::permissions(closed, fs::perms(0700));
    const int status = test::in_child([&] {
      if (!test::be_bound_by_rights()) {
        return 9;
      }
      const std::vector<Error> damaged = check().damaged;
      return damaged.size() == 1 && damaged.front().where == as &&
                     damaged.front().what == "cannot read the folder: Permission denied" &&
                     damaged.front().mend.find("rights") != std::string::npos
                 ? 0
                 : 1;
    });
    fs::permissions(closed, fs::perms(0755));
    return status;
  };
  EXPECT_EQ(told_in_child(bag() / "data", "data/"), 0);
  EXPECT_EQ(told_in_child(bag(), bag().string()), 0);
}

TEST_F(BagTest, WhatIsStillToBeFetchedIsMissing) {
  fs::remove(bag() / "data/master.ply");
  put("fetch.txt", "https://example.org/master.ply 14 data/master.ply\n");
  EXPECT_THAT(faults(), Contains("data/master.ply: not here: fetch.txt says where it is"));
}

TEST(BagText, PathsAreDecodedOnce) {
  EXPECT_EQ(decode_bag_path("a%0Ab%0dc%2525%20"), "a\nb\rc%25%20");
  EXPECT_EQ(decode_bag_path("%2"), "%2");
  EXPECT_EQ(decode_bag_path("a%0Ab%0dc%2525%20", {0, 97}), "a\nb\rc%2525%20");
}

}  // namespace
}  // namespace dubsar
