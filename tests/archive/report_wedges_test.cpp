// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the report tells of the wedges: their number, and how their features are distributed on each side.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "archive/report_sections.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ReportWedges : public ::testing::Test {
 protected:
  static std::string section(const std::vector<WedgeProfile>& profiles,
                             const std::string& sentence = "<9> wedges.") {
    return wedges_section(sentence, profiles);
  }

  /// The median of the k-th feature is `first` + k, its tenth 0.04 less, its nine-tenths 0.04 more.
  static WedgeProfile profile(std::optional<Face> side, int count, double first) {
    WedgeProfile out;
    out.side = side;
    out.count = count;
    for (std::size_t f = 0; f < kWedgeFeatures.size(); ++f) {
      for (std::size_t q = 0; q < kProfileQuantiles; ++q) {
        out.quantiles[f][q] = first + static_cast<double>(f) + 0.01 * (static_cast<double>(q) - 4.0);
      }
    }
    out.known.fill(count);
    out.kinds = {0.25, 0.5, 0, 0, 0.25, 0};
    return out;
  }
};

TEST_F(ReportWedges, AreToldByTheirMediansOnEachSide) {
  const std::string html =
      section({profile(std::nullopt, 9, 0.5), profile(Face::kObverse, 5, 20), profile(Face::kTop, 4, 40)});
  EXPECT_THAT(html, HasSubstr("&lt;9&gt; wedges."));
  EXPECT_THAT(html, HasSubstr("<td>Wedges</td><td>9</td><td>5</td><td>4</td>"));
  EXPECT_THAT(html, HasSubstr("<td>Depth, mm</td><td>0.50 (0.46 to 0.54)</td><td>20.00 (19.96 to 20.04)</td>"
                              "<td>–</td>"))
      << "of four wedges no distribution is told";
  EXPECT_THAT(html, HasSubstr("<td>Directional edge, mm</td><td>1.50 (1.46 to 1.54)</td>"));
  EXPECT_THAT(html,
              HasSubstr("<td>Opening at the third edge, °</td><td>8 (7 to 8)</td><td>27 (27 to 27)</td>"));
  EXPECT_THAT(html, HasSubstr("<td>vertical, %</td><td>50</td><td>50</td><td>50</td>"));
  EXPECT_THAT(html, Not(HasSubstr("The mesh ends before")));
}

TEST_F(ReportWedges, LengthsThatAreInNoRowAreCountedOnce) {
  WedgeProfile all = profile(std::nullopt, 9, 0.5);
  all.beyond_mesh = 2;
  WedgeProfile side = profile(Face::kLeft, 9, 0.5);
  side.beyond_mesh = 2;
  all.quantiles[1].fill(0);  // no length is known
  all.known[1] = 0;
  const std::string html = section({all, side});
  EXPECT_THAT(html, HasSubstr("The mesh ends before 2 edges do: their lengths are in no row."));
  EXPECT_THAT(html, HasSubstr("<td>Directional edge, mm</td><td>–</td>"));
}

TEST_F(ReportWedges, WhatFewerThanFiveSayIsToldOfNoFeature) {
  WedgeProfile all = profile(std::nullopt, 6, 0.5);
  all.beyond_mesh = 2;
  all.known[1] = 4;
  WedgeProfile side = profile(Face::kObverse, 6, 0.5);
  side.beyond_mesh = 1;
  side.known[1] = 5;
  std::fill(side.known.begin() + kWedgeLengths, side.known.end(), 3);
  const std::string html = section({all, side});
  EXPECT_THAT(html, HasSubstr("<td>Depth, mm</td><td>0.50 (0.46 to 0.54)</td><td>0.50 (0.46 to 0.54)</td>"));
  EXPECT_THAT(html, HasSubstr("<td>Directional edge, mm</td><td>–</td><td>1.50 (1.46 to 1.54)</td>"));
  EXPECT_THAT(html, HasSubstr("<td>Wedges that angles are read at</td><td>6</td><td>3</td>"));
  EXPECT_THAT(html, HasSubstr("<td>Opening at it, °</td><td>6 (5 to 6)</td><td>–</td>"));
}

TEST_F(ReportWedges, ThereIsNoTableOfNothing) {
  EXPECT_EQ(section({profile(std::nullopt, 9, 0.5)}, ""), "") << "nobody looked for them";
  EXPECT_THAT(section({}), Not(HasSubstr("<table")));
  EXPECT_THAT(section({WedgeProfile{}}), Not(HasSubstr("<table")));
}

TEST_F(ReportWedges, APageTakesOtherWordsOnThem) {
  const std::string before = "<section>\n<h2>Scans</h2>\n</section>\n";
  const std::string behind = "<section>\n<h2>Accuracy</h2>\n</section>\n";
  const WedgeProfile now = profile(std::nullopt, 8, 0.5);
  EXPECT_EQ(page_with_wedges(before + section({profile(std::nullopt, 9, 0.5)}) + behind, "8 wedges.", {now}),
            before + section({now}, "8 wedges.") + behind);
  EXPECT_EQ(page_with_wedges(before + behind, "8 wedges.", {now}), before + behind);
}

}  // namespace
}  // namespace dubsar
