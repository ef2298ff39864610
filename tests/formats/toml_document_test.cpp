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

}  // namespace
}  // namespace dubsar
