// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/toml_document.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

// Under the undefined-behaviour sanitizer these ended in toml++.
TEST(TomlDocument, ALetterThatIsNoSpaceIsKeptAfterALineThatGoesOn) {
  const auto document = parse_toml("note = \"\"\"\\\n  \u00e4rmel, 3 \u00b5m\"\"\"\n", "rig.toml");
  ASSERT_TRUE(document) << document.error().line();
  EXPECT_EQ(document->root().at("note").text(), "\u00e4rmel, 3 \u00b5m");
}

TEST(TomlDocument, ALetterWhereNoneMayStandIsBadInputOfThatLine) {
  for (const char* letter : {"\u00a1", "\u00e4", "\u0416", "\u3042", "\ufb26"}) {
    const auto document = parse_toml("rows = 3\nboard " + std::string(letter) + " = 1\n", "rig.toml");
    ASSERT_FALSE(document) << letter;
    EXPECT_EQ(document.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(document.error().what, ::testing::HasSubstr("line 2")) << letter;
  }
}

std::string dotted(int keys) {
  std::string key = "a";
  for (int k = 1; k < keys; ++k) {
    key += ".a";
  }
  return key;
}

// The largest of these ended in an overflow of the stack, smaller ones took gigabytes.
TEST(TomlDocument, KeysOfTooManyDotsAreBadInputOfTheirLine) {
  for (const int keys : {66, 500'000}) {
    const std::string key = dotted(keys);
    for (const std::string& line :
         {key + " = 1\n", "[" + key + "]\n", "[[" + key + "]]\n", "b = {" + key + " = 1}\n",
          "b = [\"]\", '#', {" + key + " = 1}]\n", "b = {c = \"\"\"d\"\"\"\", " + key + " = 1}\n"}) {
      const auto document = parse_toml("note = \"\"\"\n[\"\"\"  # [\n" + line, "rig.toml");
      ASSERT_FALSE(document) << keys << ": " << line.substr(0, 20);
      EXPECT_EQ(document.error().kind, ErrorKind::kBadInput);
      EXPECT_EQ(document.error().what, "line 3: nested deeper than 64 levels");
    }
  }
}

TEST(TomlDocument, DotsThatNestNothingAreAsManyAsTheyLike) {
  std::string text = "# " + dotted(100) + "\nnote = \"" + dotted(100) + "\"\nplace = '" + dotted(100) +
                     "'\nlong = \'\'\'\n" + dotted(100) + "\n" + dotted(100) + "\'\'\'\nquoted = \"\\\"" +
                     dotted(100) + "\"\nnumbers = [\n";
  for (int k = 0; k < 100; ++k) {
    text += "  1.5, [2.5, 3.5],\n";
  }
  text += "]\n";
  for (int k = 0; k < 100; ++k) {
    text += "[[table]]\nfrom.mm = 1.5\n";
  }
  const auto document = parse_toml(text, "rig.toml");
  ASSERT_TRUE(document) << document.error().line();
  EXPECT_EQ(document->root().at("numbers").size(), 200U);
  EXPECT_EQ(document->root().at("note").text(), dotted(100));
  ASSERT_TRUE(parse_toml(dotted(60) + " = 1\n", "rig.toml"));
}

}  // namespace
}  // namespace dubsar
