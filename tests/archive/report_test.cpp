// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Report : public ::testing::Test {
 protected:
  Report() : mesh_(coloured_box(50, 40, 20)) {
    map_.conclusive = true;
    list_.conclusive = true;
    list_.store_whole = true;
    list_.scans_registered = 2;
    for (FaceCoverage& face : list_.faces) {
      face.seen_mm2 = 800;
    }
    for (int i = 0; i < 2; ++i) {
      ScanPose pose;
      pose.id = i;
      pose.file = "scan_00" + std::to_string(i) + ".ply";
      pose.status = PoseStatus::kRegistered;
      pose.rms_mm = 0.0213;
      scans_.push_back(pose);
    }
  }

  std::string html() {
    const JobContext job;
    const ReportInput input{.title = title_,
                            .tool_version = "Dubsar",
                            .when = "2026-01-02T03:04:05Z",
                            .device = device_,
                            .model = mesh_,
                            .red_map = map_,
                            .checklist = list_,
                            .scans = scans_,
                            .red_points = {},
                            .tablet_from_model = {},
                            .accuracy = {"Measured on a ball bar."},
                            .calibration = {},
                            .not_measured = {"Colour."},
                            .timings = {{"stitch", 1.5}},
                            .longest_px = 80};
    const auto page = report_html(input, job);
    EXPECT_TRUE(page) << page.error().line();
    return page.value_or("");
  }

  static std::size_t count(const std::string& text, const std::string& word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
      ++n;
    }
    return n;
  }

  std::string title_ = "BM 15285";
  std::string device_ = "sim:";
  Mesh mesh_;
  RedMap map_;
  Checklist list_;
  std::vector<ScanPose> scans_;
};

TEST_F(Report, HoldsSixSidesAndTheRedMapAndLoadsNothing) {
  const std::string page = html();
  EXPECT_EQ(count(page, "<img "), 7U);
  EXPECT_EQ(count(page, "src=\"data:image/png;base64,"), 7U);
  for (int f = 0; f < kFaceCount; ++f) {
    EXPECT_THAT(page, HasSubstr("<figcaption>" + std::string(to_string(static_cast<Face>(f)))));
  }
  EXPECT_THAT(page, HasSubstr(">10 mm</div>")) << "the scale of the six sides";
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, Not(HasSubstr("url(")));
}

TEST_F(Report, ElementsAreClosedInOrder) {
  std::string page = html();
  page = page.substr(page.find("</style>") + 8);
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const bool closes = page[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = page.substr(begin, page.find_first_of(" >\n", begin) - begin);
    if (name == "img") {
      continue;
    }
    if (!closes) {
      open.push_back(name);
    } else if (!open.empty()) {
      ASSERT_EQ(open.back(), name);
      open.pop_back();
    } else {
      ASSERT_TRUE(name == "head" || name == "html") << name;
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST_F(Report, SaysConclusiveOnlyWhenBothJudgesDo) {
  EXPECT_THAT(html(), HasSubstr("<h2>Conclusive</h2>"));
  list_.conclusive = false;
  list_.scans_unsure = 2;
  const std::string unsure = html();
  EXPECT_THAT(unsure, HasSubstr("<h2>Not conclusive</h2>"));
  EXPECT_THAT(unsure, HasSubstr("2 scans are unsure"));
  list_.conclusive = true;
  map_.conclusive = false;
  EXPECT_THAT(html(), HasSubstr("<h2>Not conclusive</h2>"));
}

TEST_F(Report, ListsRedPlacesTheirSizesAndWhatToDoNext) {
  map_.conclusive = list_.conclusive = false;
  RedRegion red;
  red.face = Face::kTop;
  red.area_mm2 = 3.25;
  red.center_mm = {1.5F, 19.0F, 2.0F};
  RedRegion excused;
  excused.state = RegionState::kExcused;
  excused.excuse = Excuse::kUnreachable;
  excused.area_mm2 = 12;
  excused.reason = "no pose sees the floor of this hole";
  map_.regions = {excused, red};
  map_.next.push_back({{}, 3.0, "turn the top edge towards the camera, 40°", std::nullopt});
  const std::string page = html();
  EXPECT_THAT(page, HasSubstr("1 place is still red, 3.25 mm²"));
  EXPECT_THAT(page, HasSubstr("turn the top edge towards the camera, 40°"));
  EXPECT_THAT(page, HasSubstr("<td>red</td><td>top</td><td>1.5, 19.0, 2.0</td><td>3.25</td>"));
  EXPECT_THAT(page, HasSubstr("no pose sees the floor of this hole"));
  EXPECT_LT(page.find("<td>red</td>"), page.find("<td>unreachable</td>")) << "what is to be done comes first";
}

TEST_F(Report, EscapesEveryOutsideWord) {
  const std::string evil = "<script>alert(1)</script>\" onload='x";
  title_ = device_ = evil;
  list_.calibration = evil;
  scans_[0].file = scans_[0].reason = evil;
  RedRegion region;
  region.reason = evil;
  map_.regions.push_back(region);
  map_.conclusive = false;
  map_.next.push_back({{}, 1.0, evil, std::nullopt});
  const std::string page = html();
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("onload='")));
  EXPECT_GE(count(page, "&lt;script&gt;alert(1)&lt;/script&gt;&quot; onload=&#39;x"), 8U);
}

TEST_F(Report, WithoutASurfaceSaysSo) {
  mesh_ = {};
  map_.conclusive = list_.conclusive = false;
  const std::string page = html();
  EXPECT_THAT(page, HasSubstr("No surface was meshed, so there is nothing to show."));
  EXPECT_EQ(count(page, "<img "), 0U);
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST_F(Report, WithoutAnythingAtAllIsStillAPage) {
  mesh_ = {};
  map_ = {};
  list_ = {};
  scans_.clear();
  title_.clear();
  EXPECT_THAT(html(), HasSubstr("Untitled tablet"));
}

TEST_F(Report, NumbersThatAreNoneAreDashes) {
  scans_[1].rms_mm = std::nan("");
  const std::string page = html();
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_THAT(page, HasSubstr("<td>21.3</td>"));
}

TEST_F(Report, SameInputSameBytes) {
  EXPECT_EQ(html(), html());
}

TEST_F(Report, TableOfManyPlacesStaysReadable) {
  map_.regions.resize(2000);
  for (std::size_t i = 0; i < map_.regions.size(); ++i) {
    map_.regions[i].area_mm2 = 1.0;
  }
  EXPECT_THAT(html(), HasSubstr("1500 smaller places, 1500.00 mm² together"));
}

TEST_F(Report, StopsWhenAsked) {
  JobContext job;
  job.cancel();
  const ReportInput input{.title = "",
                          .tool_version = "",
                          .when = "",
                          .device = "",
                          .model = mesh_,
                          .red_map = map_,
                          .checklist = list_,
                          .scans = scans_,
                          .red_points = {},
                          .tablet_from_model = {},
                          .accuracy = {},
                          .calibration = {},
                          .not_measured = {},
                          .timings = {}};
  const auto page = report_html(input, job);
  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar
