// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/behind_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "archive/report.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const BehindPage kPage{"BM <1>", "Checklist", "2026-01-02T03:04:05Z", "scan 4 was taken out",
                       "run dubsar plan on the session"};

TEST(BehindPage, SaysWhatWasChangedAndWhenAndWhatToDoAndNoVerdict) {
  const std::string page = behind_html(kPage);
  EXPECT_THAT(page, HasSubstr("<h1>BM &lt;1&gt;</h1>"));
  EXPECT_THAT(page, HasSubstr("The session was changed on 2026-01-02T03:04:05Z: scan 4 was taken out."));
  EXPECT_THAT(page, HasSubstr("run dubsar plan on the session"));
  for (const char* word : {"onclusive", "It holds", "Signed", "Sign-off"}) {
    EXPECT_THAT(page, Not(HasSubstr(word)));
  }
  EXPECT_THAT(page, ::testing::EndsWith("</html>\n"));
}

TEST(BehindPage, GoesByTheNumberThatTheTabletIsGivenSince) {
  BehindPage page = kPage;
  page.title = "K. 1";
  EXPECT_EQ(page_renamed(behind_html(kPage), "K. 1", {}), behind_html(page));
}

TEST(BehindPage, IsKnownByItsFirstBytesWhateverItIsAbout) {
  BehindPage page = kPage;
  page.title = std::string(2000, 'x');
  EXPECT_TRUE(is_behind_page(behind_html(page).substr(0, kBehindHeadBytes)));
  EXPECT_FALSE(is_behind_page("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<title>behind</title>"));
  EXPECT_FALSE(is_behind_page(""));
}

TEST(BehindPage, ThePictureHasRoomForItsWords) {
  const Image image = behind_picture(kPage);
  BehindPage longer = kPage;
  longer.what += std::string(100, '!');
  EXPECT_GT(behind_picture(longer).width, image.width);
  int inked = 0;
  for (int y = 0; y < image.height; ++y) {
    EXPECT_EQ(image.rgb(image.width - 1, y), (Rgb8{255, 255, 255})) << "nothing is cut off";
    for (int x = 0; x < image.width; ++x) {
      inked += image.rgb(x, y) != Rgb8{255, 255, 255} ? 1 : 0;
    }
  }
  EXPECT_GT(inked, 1000);
}

}  // namespace
}  // namespace dubsar
