// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Files that carry their own checksum, and the two that do.

#include "formats/self_checked.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/selections_json.h"
#include "formats/xxh128.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(SelfChecked, TheSumIsThatOfXxhsumOverAllBeforeTheComma) {
  EXPECT_EQ(xxh128_hex(""), "99aa06d3014798d86001c324468d497f");  // printf '' | xxh128sum
  const std::string text = with_own_checksum("{\"a\":1}\n");
  EXPECT_EQ(text, R"({"a":1,"xxh128":"61a0fe76ffe4dee06812ff298dd1912b"})"
                  "\n");
  EXPECT_EQ(own_checksum_of(text), OwnChecksum::kFits);
  EXPECT_EQ(own_checksum_of(text.substr(0, text.size() - 1)), OwnChecksum::kFits) << "without a line's end";
  EXPECT_EQ(own_checksum_of("{\"a\":1}\n"), OwnChecksum::kNone);
  EXPECT_EQ(own_checksum_of(""), OwnChecksum::kNone);
}

TEST(SelfChecked, EveryFlippedBitIsSeen) {
  const std::string text = with_own_checksum("{\"name\":\"line 3\",\"ranges\":[[3,2]]}");
  for (std::size_t bit = 0; bit < text.size() * 8; ++bit) {
    std::string damaged = text;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_EQ(own_checksum_of(damaged), OwnChecksum::kFails) << bit;
  }
}

TEST(SelfChecked, ADamagedChecksumIsNotTakenForNone) {
  const std::string text = with_own_checksum("{\"name\":\"line 3\"}");
  for (std::size_t size = text.find("\":\"", 16) + 3; size + 1 < text.size(); ++size) {
    EXPECT_EQ(own_checksum_of(text.substr(0, size)), OwnChecksum::kFails) << "cut off after " << size;
  }
  EXPECT_EQ(own_checksum_of(text + "}"), OwnChecksum::kFails);
  for (const char* never_had_one :
       {R"({"mesh":"tablet.ply","surface_xxh128":"782af462703cbb1f695bbd6be2ca1ae7","selections":[]})",
        R"({"unit":"mm","corrections":[[1,2,3]]})"}) {
    EXPECT_EQ(own_checksum_of(never_had_one), OwnChecksum::kNone) << never_had_one;
  }
}

class SelfCheckedFiles : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "kept.json";
};

TEST_F(SelfCheckedFiles, ADamagedSelectionIsRefusedAndOneEditedOnPurposeIsNot) {
  ASSERT_TRUE(write_selections(path_, {"t.ply", "0", {{"line 3", MeshElement::kFace, {{7, 2}}}}}));
  EXPECT_TRUE(read_selections(path_));
  std::string text = *read_whole_file(path_);
  EXPECT_THAT(text, EndsWith("\"}\n"));
  text.replace(text.find("line 3"), 6, "line 4");
  const Result<SelectionFile> refused = parse_selections(text, "s.json");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr("checksum"));
  text.resize(text.find(",\"xxh128\""));
  text += '}';
  EXPECT_EQ(parse_selections(text, "s.json")->selections[0].name, "line 4");
}

TEST_F(SelfCheckedFiles, ADamagedCorrectionIsRefused) {
  WedgeCorrection gone;
  gone.kind = CorrectionKind::kDelete;
  gone.at_mm = {{1, 2, 3}};
  ASSERT_TRUE(write_corrections(path_, {"t.ply", {gone}}));
  std::string text = *read_whole_file(path_);
  EXPECT_TRUE(parse_corrections(text, "c.json"));
  text.replace(text.find("t.ply"), 5, "u.ply");
  EXPECT_FALSE(parse_corrections(text, "c.json"));
}

TEST_F(SelfCheckedFiles, CorrectionsTakeThePlaceOfThoseTheyWereMadeOfAlone) {
  WedgeCorrection one;
  one.at_mm = {{1, 2, 3}};
  WedgeCorrection two = one;
  two.at_mm[0].z() = 4;
  ASSERT_TRUE(replace_corrections(path_, {}, {"t.ply", {one}}));
  EXPECT_EQ(replace_corrections(path_, {}, {"t.ply", {two}}).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(read_corrections(path_)->corrections.front().at_mm, one.at_mm);
  EXPECT_TRUE(replace_corrections(path_, {one}, {"t.ply", {one, two}}));
  EXPECT_EQ(read_corrections(path_)->corrections.size(), 2U);
}

}  // namespace
}  // namespace dubsar
