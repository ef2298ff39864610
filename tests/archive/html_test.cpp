// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/html.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/comma_locale.h"

namespace dubsar {
namespace {

const std::string kReplaced = "\xEF\xBF\xBD";

TEST(HtmlEscaped, DisarmsMarkup) {
  EXPECT_EQ(html_escaped("<script>alert('x') && \"y\"</script>"),
            "&lt;script&gt;alert(&#39;x&#39;) &amp;&amp; &quot;y&quot;&lt;/script&gt;");
}

TEST(HtmlEscaped, KeepsForeignLetters) {
  EXPECT_EQ(html_escaped("Ḫattuša 𒁾𒊬"), "Ḫattuša 𒁾𒊬");
}

TEST(HtmlEscaped, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(html_escaped("a\xFF"), "a" + kReplaced);
  EXPECT_EQ(html_escaped("\xC3"), kReplaced);                                   // cut off
  EXPECT_EQ(html_escaped("\xC0\xAF"), kReplaced + kReplaced);                   // overlong '/'
  EXPECT_EQ(html_escaped("\xED\xA0\x80"), kReplaced + kReplaced + kReplaced);   // surrogate
  EXPECT_EQ(html_escaped("\xF4\x90\x80\x80").find("\xF4"), std::string::npos);  // above U+10FFFF
}

TEST(HtmlEscaped, TakesLinesAsAnySystemEndsThem) {
  EXPECT_EQ(html_escaped("joins K. 1\r\nchipped\rdusty\n"), "joins K. 1\nchipped\ndusty\n");
}

TEST(HtmlEscaped, ReplacesControlsAndMarksThatTurnTheDirectionOfWriting) {
  EXPECT_EQ(html_escaped(std::string("a\0b\x1B", 4)), "a" + kReplaced + "b" + kReplaced);
  EXPECT_EQ(html_escaped("scan\u202Eylp.exe"), "scan" + kReplaced + "ylp.exe");
}

TEST(Fixed, WritesNumbersAndAdmitsWhatIsNone) {
  EXPECT_EQ(fixed(3.14159, 2), "3.14");
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 2), "–");
  EXPECT_EQ(fixed(std::numeric_limits<double>::infinity(), 2), "–");
  const test::CommaLocale comma;  // as a host program may have set it
  EXPECT_EQ(fixed(3.14159, 2), "3.14");
}

TEST(Counted, AgreesInNumber) {
  EXPECT_EQ(counted(1, "scan", "scans"), "1 scan");
  EXPECT_EQ(counted(0, "scan", "scans"), "0 scans");
}

}  // namespace
}  // namespace dubsar
