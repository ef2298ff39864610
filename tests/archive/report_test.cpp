// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
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

  ReportInput input() {
    return {.title = title_,
            .tablet = tablet_,
            .tool_version = "Dubsar",
            .when = "2026-01-02T03:04:05Z",
            .device = device_,
            .model = mesh_,
            .red_map = map_,
            .checklist = list_,
            .scans = scans_,
            .entries = entries_,
            .red_points = {},
            .tablet_from_model = {},
            .wedges = "3 wedges <were> measured.",
            .accuracy = {"Measured on a ball bar."},
            .calibration = {},
            .not_measured = {"Colour."},
            .timings = {{"stitch", 1.5}},
            .longest_px = 80};
  }
  std::string html(const std::function<Result<std::string>(const ReportInput&, const ReportPictures&)>&
                       page_of = report_html) {
    const JobContext job;
    const ReportInput all = input();
    const auto pictures = draw_pictures(all, job);
    EXPECT_TRUE(pictures) << pictures.error().line();
    const auto page = page_of(all, pictures.value_or(ReportPictures{}));
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

  std::vector<ScanEntry> entries_;
  std::string title_ = "BM 15285";
  TabletWords tablet_;
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

TEST_F(Report, TheSixSidesShrinkTogetherWhereTheScreenIsNarrow) {
  // Columns share the width as the sides do, and a side takes its share of its column: all to one scale at
  // any width. The box is 50 x 40 x 20 mm.
  const std::string page = html();
  const auto number_after = [&](const std::string& mark, std::size_t from = 0) {
    const std::size_t at = page.find(mark, from);
    EXPECT_NE(at, std::string::npos) << mark;
    return at == std::string::npos ? 0.0 : std::stod(page.substr(at + mark.size()));
  };
  const std::size_t cross = page.find("<div class=\"cross\"");
  const double left = number_after("--left: ", cross);
  const double column = number_after("--column: ", cross);
  const double right = number_after("--right: ", cross);
  EXPECT_NEAR(number_after("--wide: ", cross), left + column + right, 0.02);
  EXPECT_NEAR(column / left, 2.5, 0.6);  // margins of pixels that are 0.6 mm wide here
  for (const auto& [name, room] : {std::pair{"top", column}, std::pair{"left", left},
                                   std::pair{"obverse", column}, std::pair{"reverse", column}}) {
    const std::size_t at = page.find("alt=\"The " + std::string(name) + "\"");
    const double share = number_after("--share: ", at);
    EXPECT_LE(share, 100.001) << name;
    EXPECT_NEAR(share * room / 100, number_after("--mm: ", at), 0.02) << name;
  }
  EXPECT_THAT(page, HasSubstr(".cross img { width: var(--share)"));
  EXPECT_THAT(page, HasSubstr(".sheet img { width: auto; height: auto;")) << "else it is drawn out of shape";
}

TEST_F(Report, IsRenamedWithoutBeingMadeAnew) {
  const std::string before = html();
  tablet_ = {{"Museum number", "K. <1>"}, {"Notes", "in two pieces"}};
  title_ = "P000001";
  EXPECT_EQ(page_renamed(before, title_, tablet_), html()) << "as if it had been so from the start";
  EXPECT_EQ(page_renamed(html(), "BM 15285", {}), before);
  EXPECT_EQ(page_renamed("<p>no page of ours</p>", "X", tablet_), "<p>no page of ours</p>");
  const JobContext job;
  const std::string checklist = html([](const ReportInput& i, const ReportPictures& p) {
    return Result<std::string>(checklist_html(i, p));
  });
  EXPECT_THAT(checklist, HasSubstr("<title>P000001: checklist</title>"));
  EXPECT_THAT(page_renamed(checklist, "M 2", {}), HasSubstr("<title>M 2: checklist</title>"));
  EXPECT_THAT(page_renamed(checklist, "M 2", {}), HasSubstr("<h1>M 2</h1>\n<dl>\n<dt>Made</dt>"));
}

TEST_F(Report, LostScansAreNamed) {
  map_.conclusive = list_.conclusive = false;
  list_.store_whole = false;
  EXPECT_THAT(html(), HasSubstr("Not every stored byte was checked"));
  list_.store_checked = "2026-01-02T03:04:05Z";
  list_.scans_lost = {0, 1, 3};
  for (const std::string& page :
       {html(), html([](const ReportInput&all, const ReportPictures&pictures) -> Result<std::string> {
          return checklist_html(all, pictures);
        })}) {
    EXPECT_THAT(page, HasSubstr("The session has lost scans 0, 1 and 3: "));
    EXPECT_THAT(page, HasSubstr("<dt>Lost</dt><dd>scans 0, 1 and 3"));
    EXPECT_THAT(page, HasSubstr("Not every stored file is there and matches its checksum"));
    EXPECT_THAT(page, Not(HasSubstr("was checked")));
  }
}

TEST_F(Report, ScansWithoutAPlaceAreNamed) {
  EXPECT_THAT(html(), Not(HasSubstr("laced yet")));
  map_.conclusive = list_.conclusive = false;
  list_.scans_unplaced = {3, 4};
  entries_ = {{.id = 3, .file = "d<3>.ply", .when = "2026-11-27T23:07:05Z"}};
  for (const std::string& page :
       {html(), html([](const ReportInput&all, const ReportPictures&pictures) -> Result<std::string> {
          return checklist_html(all, pictures);
        })}) {
    EXPECT_THAT(page, HasSubstr("No place was worked out yet for scans 3 and 4: "));
    EXPECT_THAT(page, HasSubstr("<dt>Not placed yet</dt><dd>scans 3 and 4, stored"));
  }
  const std::string report = html();
  EXPECT_THAT(report, HasSubstr("<td>3</td><td>d&lt;3&gt;.ply<br><span class=\"aside\">stored 2026-11-27 "
                                "23:07:05 UTC</span></td><td>not placed yet</td>"));
  EXPECT_THAT(report, HasSubstr("<td>4</td><td></td><td>not placed yet</td>"));
}

TEST_F(Report, ScansThatFitOneAnotherAloneAreToldWithWhatJoinsThem) {
  map_.apart = {{{2, 3}, "scans 2 and 3 fit one another, and not scans <0>"}};
  map_.conclusive = list_.conclusive = false;
  EXPECT_THAT(html(), HasSubstr("<li>Scans 2 and 3 fit one another, and not scans &lt;0&gt;.</li>"));
}

TEST_F(Report, SaysWhenItWasScannedAndWhatWasTakenOut) {
  const std::string silent = html();
  EXPECT_THAT(silent, Not(HasSubstr("<dt>Scanned</dt>")));
  EXPECT_THAT(silent, Not(HasSubstr("taken out")));
  entries_ = {{.id = 0, .file = "scan_000.ply", .when = "2026-11-27T23:07:05Z", .by_device = true},
              {.id = 1, .file = "scan_001.ply", .when = "2026-11-27T23:08:09Z"},
              {.id = 2, .file = "b<a>d.ply", .when = {}, .taken_out = true, .why = "dust & hair"},
              {.id = 3, .taken_out = true}};
  const std::string page = html();
  EXPECT_THAT(page, HasSubstr("<dt>Scanned</dt><dd>2026-11-27, 23:07 to 23:08 UTC, by when the session"));
  EXPECT_THAT(page, HasSubstr("scan_000.ply<br><span class=\"aside\">2026-11-27 23:07:05 UTC</span></td>"));
  EXPECT_THAT(page, HasSubstr("scan_001.ply<br><span class=\"aside\">stored 2026-11-27 23:08:09 UTC</span>"));
  EXPECT_THAT(page, HasSubstr("<td>2</td><td>b&lt;a&gt;d.ply</td><td>taken out</td>"));
  EXPECT_THAT(page, HasSubstr("<td>dust &amp; hair</td></tr>"));
  EXPECT_THAT(page, HasSubstr("<td>no reason was given</td></tr>"));
}

TEST(ScanEntries, SayFromWhenToWhen) {
  EXPECT_EQ(scanned_in_words({{.id = 0}}), "");
  EXPECT_EQ(scanned_in_words({{.id = 0, .when = "2026-11-27T23:07:05Z", .by_device = true}}),
            "2026-11-27, 23:07 UTC");
  EXPECT_EQ(scanned_in_words({{.id = 0, .when = "2026-11-28T00:12:00Z", .by_device = true},
                              {.id = 1, .when = "2026-11-27T23:07:05Z", .by_device = true}}),
            "2026-11-27, 23:07 to 2026-11-28, 00:12 UTC");
  EXPECT_EQ(taken_out_in_words(
                {{.id = 0}, {.id = 3, .taken_out = true, .why = "dust"}, {.id = 7, .taken_out = true}}),
            "scan 3 (dust), scan 7 (no reason was given)");
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

TEST_F(Report, PromisesNothingOfWhatIsOutOfReach) {
  const auto excuse = [](Excuse why, double area_mm2) {
    RedRegion region;
    region.state = RegionState::kExcused;
    region.excuse = why;
    region.area_mm2 = area_mm2;
    return region;
  };
  const char* all = "Nobody has to touch the tablet again for its shape.";
  EXPECT_THAT(html(), HasSubstr(all));
  map_.regions = {excuse(Excuse::kUnneeded, 0.2)};
  EXPECT_THAT(html(), HasSubstr(all));
  map_.regions.push_back(excuse(Excuse::kUnreachable, 1900));
  map_.regions.push_back(excuse(Excuse::kUnreachable, 100));
  const std::string page = html();
  EXPECT_THAT(page, HasSubstr("<h2>Conclusive</h2>"));
  EXPECT_THAT(page, Not(HasSubstr(all)));
  EXPECT_THAT(page, HasSubstr("2 places are out of its reach, 2000.0 mm²"));
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
  EXPECT_THAT(page, HasSubstr("<b>2</b> red, top, 3.25 mm²<br>at 1.5, 19.0, 2.0 mm"));
  EXPECT_THAT(page, HasSubstr("<b>1</b> unreachable, obverse, 12.00 mm²"));
  EXPECT_THAT(page, HasSubstr("no pose sees the floor of this hole"));
  EXPECT_LT(page.find("<b>2</b> red"), page.find("<b>1</b> unreachable")) << "what is to be done comes first";
  EXPECT_EQ(count(page, "<img "), 9U) << "six sides, the red map, and each place";
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

TEST_F(Report, AScanThatWasHeldAgainstNoOtherHasNoResidual) {
  scans_.resize(1);
  list_.worst_sigma_scan = 0;
  EXPECT_THAT(html(), HasSubstr("the median residual between scans is 21.3 µm"));
  EXPECT_THAT(html(), HasSubstr("<dt>Worst place</dt>"));
  scans_[0].rms_mm = 0;
  list_.scans_registered = 1;
  const std::string page = html();
  EXPECT_THAT(page, Not(HasSubstr("<dt>Worst place</dt>")));
  EXPECT_THAT(page, Not(HasSubstr("the median residual")));
  EXPECT_THAT(page, HasSubstr("<td>registered</td><td>–</td>"));
}

TEST_F(Report, SameInputSameBytes) {
  EXPECT_EQ(html(), html());
}

TEST_F(Report, TableOfManyPlacesStaysReadable) {
  map_.regions.resize(2000);
  for (std::size_t i = 0; i < map_.regions.size(); ++i) {
    map_.regions[i].area_mm2 = 1.0;
  }
  EXPECT_THAT(html(), HasSubstr("1476 smaller places, 1476.00 mm² together"));
}

TEST_F(Report, StraysAreCountedInOneLine) {
  RedRegion stray;
  stray.state = RegionState::kExcused;
  stray.excuse = Excuse::kUnneeded;
  stray.reason = "stray return in the air";
  map_.regions.assign(7, stray);
  const std::string page = html();
  EXPECT_THAT(page, HasSubstr("7 groups of stray returns"));
  EXPECT_THAT(page, Not(HasSubstr("stray return in the air")));
  EXPECT_THAT(page, Not(HasSubstr("excused, "))) << "nothing that lacks clay is excused";
  EXPECT_EQ(count(page, "<img "), 7U);
}

TEST_F(Report, TheNumberOfAPlaceWiderThanThePictureIsInIt) {
  RedRegion stray;
  stray.state = RegionState::kExcused;
  stray.excuse = Excuse::kUnneeded;
  RedRegion wide;
  wide.area_mm2 = 30000;
  wide.normal = {0, 0, 1};
  wide.center_mm = {0, 0, 10};
  const auto sheet = [&](std::vector<RedRegion> regions) {
    map_.regions = std::move(regions);
    const auto pictures = draw_pictures(input(), JobContext());
    EXPECT_TRUE(pictures);
    return pictures ? pictures->red_sheet.bytes : std::vector<std::uint8_t>();
  };
  EXPECT_NE(sheet({wide}), sheet({stray, wide})) << "1 and 2 are told apart by their numbers alone";
}

TEST_F(Report, PlacesAreInTheFrameOfTheTablet) {
  RedRegion region;
  region.area_mm2 = 1;
  region.center_mm = {1, 2, 10};
  map_.regions = {region};
  ReportInput all = input();
  all.tablet_from_model.translation_mm = {10, 20, -10};
  const auto pictures = draw_pictures(all, JobContext());
  ASSERT_TRUE(pictures);
  EXPECT_THAT(checklist_html(all, *pictures), HasSubstr("at 11.0, 22.0, 0.0 mm"));
}

TEST_F(Report, ACopyIsToldAndCountsForNothing) {
  scans_[1].sigma_mm = 0.5;
  map_.copies = {{1, 0}};
  const std::string page = html(report_html);
  EXPECT_THAT(page, HasSubstr("<td>registered, a copy of scan 0</td>"));
  EXPECT_THAT(page, HasSubstr("displacement of a scan by its pose is 0.0 µm"));
}

TEST_F(Report, TheChecklistPageHasWhatIsSigned) {
  map_.conclusive = list_.conclusive = false;
  RedRegion red;
  red.area_mm2 = 3.25;
  red.center_mm = {1.5, 3.0, 10.0};
  map_.regions = {red};
  list_.faces[0].red_mm2 = 3.25;
  list_.faces[0].red_regions_mm2 = {2.0, 1.25};
  list_.sampling.places = 100;
  list_.sampling.spacing_mm = {0.061, std::numeric_limits<double>::infinity()};
  list_.sampling.fine_share = 0.123;
  list_.sampling.scans_share = {0.01, 0.2, 0.79, 0, 0, 0};
  list_.worst_sigma_scan = 7;
  list_.worst_sigma_mm = 0.0123;
  list_.warnings = {{3, "2 % < 3 %"}};
  list_.remarks = {{2, "2.5 mm & not 0.25"}};
  list_.calibration_check = {"2026-01-02", "ball bar 7", 0.012};
  const std::string page = html(checklist_html);
  EXPECT_THAT(page, HasSubstr("3.25 in 2: 2.00, 1.25"));
  EXPECT_THAT(page, HasSubstr("<td>99.59</td>")) << "803.25 mm², of which 800 were seen";
  EXPECT_THAT(page, HasSubstr("<td>all</td><td>61</td><td>–</td><td>12.3</td>"));
  EXPECT_THAT(page, HasSubstr("0: 1.0 %, 1: 20.0 %, 2: 79.0 %"));
  EXPECT_THAT(page, HasSubstr("scan 7, σ 12.3 µm"));
  EXPECT_THAT(page, HasSubstr("scan 3: 2 % &lt; 3 %"));
  EXPECT_THAT(page, HasSubstr("scan 2: 2.5 mm &amp; not 0.25"));
  EXPECT_THAT(page, HasSubstr("what: not told; age: not told; last verified 2026-01-02 on ball bar 7, off by "
                              "at most 12.0 µm"));
  EXPECT_THAT(page, HasSubstr("Not signed."));
  EXPECT_EQ(count(page, "<img "), 2U) << "the red map and the place";
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST_F(Report, ASignatureThatNoLongerHoldsSaysSo) {
  CheckedSignOff checked;
  checked.sign_off.name = "A <b>Reader</b>";
  checked.sign_off.when = "2026-01-02T03:04:05Z";
  checked.sign_off.digest = "abc";
  list_.sign_off = checked;
  EXPECT_THAT(html(checklist_html),
              HasSubstr("Signed by A &lt;b&gt;Reader&lt;/b&gt; on 2026-01-02T03:04:05Z."));
  EXPECT_THAT(html(checklist_html), HasSubstr("It holds"));
  list_.sign_off->changed = {"scan 3 has changed"};
  for (const std::string& page : {html(checklist_html), html()}) {
    EXPECT_THAT(page, HasSubstr("It is void"));
    EXPECT_THAT(page, HasSubstr("<li>scan 3 has changed</li>"));
    EXPECT_THAT(page, Not(HasSubstr("It holds")));
  }
}

TEST_F(Report, StopsWhenAsked) {
  JobContext job;
  job.cancel();
  const auto pictures = draw_pictures(input(), job);
  ASSERT_FALSE(pictures);
  EXPECT_EQ(pictures.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar
