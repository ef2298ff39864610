// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/script.h"

#include <gtest/gtest.h>

namespace dubsar::ui {
namespace {

TEST(Script, ReadsAStepALine) {
  const auto steps = parse_script(
      "# story\n\nkey space\nclick model 0.25 0.75\ndrag model 0 0 1 1 right\n"
      "type A. Reader\nwait idle 3\nscreenshot a b.png\nquit\n",
      "s");
  ASSERT_TRUE(steps) << steps.error().line();
  ASSERT_EQ(steps->size(), 7U);
  EXPECT_EQ((*steps)[0].name, "space");
  EXPECT_EQ((*steps)[1].numbers, (std::vector<double>{0.25, 0.75}));
  EXPECT_TRUE((*steps)[2].right);
  EXPECT_EQ((*steps)[3].name, "A. Reader");
  EXPECT_EQ((*steps)[4].numbers, std::vector<double>{3});
  EXPECT_EQ((*steps)[5].name, "a b.png");
  EXPECT_EQ((*steps)[5].line, 8);
}

TEST(Script, FactsMayHoldSpaces) {
  const auto steps = parse_script("wait scan.5.taken out\nwait scan.5.taken out 9\n", "s");
  ASSERT_TRUE(steps) << steps.error().line();
  EXPECT_EQ((*steps)[0].name, "scan.5.taken out");
  EXPECT_EQ((*steps)[1].name, "scan.5.taken out");
  EXPECT_EQ((*steps)[1].numbers, std::vector<double>{9});
}

TEST(Script, TargetsMayHoldSpaces) {
  const auto steps = parse_script("click overlay.Mean curvature, 1/mm 0.2 0.5 right\n", "s");
  ASSERT_TRUE(steps) << steps.error().line();
  EXPECT_EQ((*steps)[0].name, "overlay.Mean curvature, 1/mm");
  EXPECT_EQ((*steps)[0].numbers, (std::vector<double>{0.2, 0.5}));
  EXPECT_TRUE((*steps)[0].right);
}

TEST(Script, ADoubleClickIsSaidLikeAClick) {
  const auto steps = parse_script("doubleclick surface 0.2 0.5\ndoubleclick overlay.Mean curvature\n", "s");
  ASSERT_TRUE(steps) << steps.error().line();
  EXPECT_EQ((*steps)[0].kind, ScriptStep::Kind::kDoubleClick);
  EXPECT_EQ((*steps)[0].numbers, (std::vector<double>{0.2, 0.5}));
  EXPECT_EQ((*steps)[1].name, "overlay.Mean curvature");
  EXPECT_FALSE(parse_script("doubleclick surface 0.2\n", "s"));
}

TEST(Script, RefusesWhatSaysTooLittleByItsLine) {
  for (const char* bad : {"shout", "key", "key hyper", "drag model 0 0", "click model 0.5", "pause", "type",
                          "screenshot", "wheel model"}) {
    const auto steps = parse_script(std::string("quit\n") + bad + "\n", "s");
    ASSERT_FALSE(steps) << bad;
    EXPECT_EQ(steps.error().where, "s:2") << bad;
    EXPECT_EQ(steps.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace dubsar::ui
