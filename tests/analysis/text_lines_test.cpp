// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/text_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace dubsar {
namespace {

/// `lines` lines 5 mm apart that lean by 2 degrees, wedges of 1 to 3.4 mm in each; shuffled.
std::vector<LineMember> page(int lines, int per_line, std::vector<int>* line_of) {
  Random random(4);
  std::vector<LineMember> members;
  for (int k = 0; k < lines * per_line; ++k) {
    const int i = static_cast<int>((static_cast<std::uint64_t>(k) * 37U) %
                                   static_cast<std::uint64_t>(lines * per_line));
    const int line = i / per_line;
    LineMember m;
    m.along = 1.5 * (i % per_line);
    const double base = -5.0 * line + 0.035 * m.along;
    m.low = base + random.uniform(0.2, 1.5);
    m.high = m.low + random.uniform(1.0, 2.4);
    members.push_back(m);
    line_of->push_back(line + 1);
  }
  return members;
}

TEST(TextLines, SortsLeaningLinesAndOrdersThem) {
  std::vector<int> truth;
  std::vector<LineMember> members = page(6, 20, &truth);
  find_lines(&members);
  for (std::size_t i = 0; i < members.size(); ++i) {
    EXPECT_EQ(members[i].line, truth[i]);
    EXPECT_EQ(members[i].order, 1 + static_cast<int>(members[i].along / 1.5 + 0.5));
  }
}

/// Of `lines` full lines, 24 wedges that overlap by threes in each, one has three alone.
std::vector<LineMember> with_a_short_line(int lines, int which) {
  std::vector<LineMember> members;
  for (int line = 0; line < lines; ++line) {
    for (int k = 0; k < (line == which ? 3 : 24); ++k) {
      LineMember m;
      m.along = 1.5 * k;
      m.low = -4.5 * line + 0.3 * (k % 3);
      m.high = m.low + 3.0;
      members.push_back(m);
    }
  }
  return members;
}

TEST(TextLines, OneOfASingleSignIsALineWhereverItStands) {
  for (int which = 0; which < 6; ++which) {
    std::vector<LineMember> members = with_a_short_line(6, which);
    find_lines(&members);
    for (const LineMember& m : members) {
      const int line = 1 + static_cast<int>(-std::floor(m.low / 4.5));
      EXPECT_EQ(m.line, line) << "line " << which << " is short";
    }
  }
}

TEST(TextLines, AStrayHollowAboveALineIsNoLine) {
  std::vector<LineMember> members = with_a_short_line(4, 3);
  members.push_back({.along = 20, .low = 4.2, .high = 5.2});
  find_lines(&members);
  EXPECT_EQ(std::ranges::max(members, {}, &LineMember::line).line, 4);
}

TEST(TextLines, OneLineNoneAndOneWedge) {
  std::vector<int> truth;
  std::vector<LineMember> one_line = page(1, 12, &truth);
  find_lines(&one_line);
  for (const LineMember& m : one_line) {
    EXPECT_EQ(m.line, 1);
  }
  std::vector<LineMember> none;
  find_lines(&none);
  std::vector<LineMember> single(1);
  find_lines(&single);
  EXPECT_EQ(single[0].line, 1);
  EXPECT_EQ(single[0].order, 1);
}

}  // namespace
}  // namespace dubsar
