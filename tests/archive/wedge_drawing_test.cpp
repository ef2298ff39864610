// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/wedge_drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Wedge wedge_at(int id, Face side, double x, double y, double z) {
  Wedge wedge;
  wedge.id = id;
  wedge.place = {side, 1, id + 1, 0.0};
  wedge.depth_point_mm = {x, y, z - 0.5};
  wedge.exit_points_mm = {Eigen::Vector3d(x + 2, y, z), Eigen::Vector3d(x - 0.5, y + 0.5, z),
                          Eigen::Vector3d(x - 0.5, y - 0.5, z)};
  wedge.outer_vertices_mm = wedge.exit_points_mm;
  return wedge;
}

TEST(WedgeDrawing, IsToScaleWithOneGroupPerWedgeOfTheSide) {
  const std::vector<Wedge> wedges = {wedge_at(0, Face::kObverse, 0, 0, 5),
                                     wedge_at(1, Face::kObverse, 10, 4, 5),
                                     wedge_at(2, Face::kReverse, 3, 0, -5)};
  const std::string svg = wedge_drawing(Face::kObverse, wedges, {}, {.title = "K. 1 <a & b>"});
  // 12.5 mm from the first wedge's head to the second one's tail, 3 mm of margin on each side.
  EXPECT_THAT(svg, HasSubstr("width=\"18.500mm\""));
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 18.500 19.000\""));
  EXPECT_THAT(svg, HasSubstr("<g id=\"wedge-0\""));
  EXPECT_THAT(svg, HasSubstr("<g id=\"wedge-1\""));
  EXPECT_THAT(svg, Not(HasSubstr("<g id=\"wedge-2\"")));
  EXPECT_THAT(svg, Not(HasSubstr("data-"))) << "SVG 1.1 has no such attributes";
  EXPECT_THAT(svg, HasSubstr("K. 1 &lt;a &amp; b&gt;, obverse"));
  // Up is up: the second wedge, higher on the tablet, is nearer to the sheet's top.
  EXPECT_THAT(svg, HasSubstr("M13.500 3.500L15.500 3.500"));
  EXPECT_THAT(svg, HasSubstr("M3.500 7.500L5.500 7.500"));
}

TEST(WedgeDrawing, CarriesTheNumbersOfEachWedgeForPrograms) {
  Wedge wedge = wedge_at(7, Face::kObverse, 0, 0, 5);
  wedge.place.line = 3;
  wedge.depth_mm = 0.5;
  wedge.volume_mm3 = 0.125;
  const std::string svg = wedge_drawing(Face::kObverse, {wedge}, {}, {.title = "t"});
  const std::size_t from = svg.find("<metadata>", svg.find("<g ")) + 10;
  const auto json =
      nlohmann::json::parse(svg.substr(from, svg.find("</metadata>", from) - from), nullptr, false);
  ASSERT_TRUE(json.is_object()) << svg;
  EXPECT_EQ(json["id"], 7);
  EXPECT_EQ(json["line"], 3);
  EXPECT_EQ(json["order"], 8);
  EXPECT_EQ(json["depth_mm"], 0.5);
  EXPECT_EQ(json["volume_mm3"], 0.125);
}

TEST(WedgeDrawing, SaysOfItselfWhatItIs) {
  const std::string svg = wedge_drawing(Face::kReverse, {}, {},
                                        {.title = "K. 1", .description = "a < b", .copyright = "© A & B"});
  const std::string metadata = svg.substr(0, svg.find("</metadata>"));
  EXPECT_THAT(metadata, HasSubstr("x-default\">K. 1, reverse<"));
  EXPECT_THAT(metadata, HasSubstr("<dc:description><rdf:Alt><rdf:li xml:lang=\"x-default\">a &lt; b<"));
  EXPECT_THAT(metadata, HasSubstr("<dc:rights><rdf:Alt><rdf:li xml:lang=\"x-default\">© A &amp; B<"));
}

TEST(WedgeDrawing, MarksWhatAPersonHasCorrected) {
  Wedge added = wedge_at(1, Face::kObverse, 10, 4, 5);
  added.by_hand = ByHand::kAdded;
  const std::string svg =
      wedge_drawing(Face::kObverse, {wedge_at(0, Face::kObverse, 0, 0, 5), added}, {}, {.title = "t"});
  EXPECT_THAT(svg, HasSubstr("<g id=\"wedge-0\" class=\"wedge\">"));
  EXPECT_THAT(svg, HasSubstr("<g id=\"wedge-1\" class=\"wedge by-hand\">"));
  EXPECT_THAT(svg, HasSubstr("corrected by hand: added"));
  const std::size_t from = svg.rfind("<metadata>") + 10;
  const auto json =
      nlohmann::json::parse(svg.substr(from, svg.find("</metadata>", from) - from), nullptr, false);
  ASSERT_TRUE(json.is_object()) << svg;
  EXPECT_EQ(json["by_hand"], "added");
  EXPECT_EQ(svg.find("\"by_hand\""), svg.rfind("\"by_hand\"")) << "only of what was corrected";
}

TEST(WedgeDrawing, SaysOfALengthThatTheMeshEndsBeforeIt) {
  Wedge wedge = wedge_at(1, Face::kObverse, 10, 4, 5);
  wedge.edge_lengths_mm = {2.81, 0.73, 0.78};
  const auto drawn = [&] { return wedge_drawing(Face::kObverse, {wedge}, {}, {.title = "t"}); };
  EXPECT_THAT(drawn(), HasSubstr("edges 2.81 0.73 0.78 mm"));
  EXPECT_THAT(drawn(), Not(HasSubstr("length_beyond_mesh")));
  wedge.beyond_mesh[0] = true;
  wedge.exit_points_surface_mm = wedge.exit_points_mm;
  EXPECT_THAT(drawn(), HasSubstr("edges 2.81 (the mesh ends before it) 0.73 0.78 mm"));
  EXPECT_THAT(drawn(), HasSubstr(R"("length_beyond_mesh":true})"));
  // Measured to where the edge was seen last it is no guess.
  wedge.exit_points_surface_mm[0] += Eigen::Vector3d(1, 0, 0);
  EXPECT_THAT(drawn(), HasSubstr("edges 2.81 0.73 0.78 mm"));
  EXPECT_THAT(drawn(), Not(HasSubstr("length_beyond_mesh")));
}

TEST(WedgeDrawing, WritesASheetForEachSideThatHasWedges) {
  const test::TemporaryFolder folder;
  const std::vector<Wedge> wedges = {wedge_at(0, Face::kObverse, 0, 0, 5),
                                     wedge_at(2, Face::kReverse, 3, 0, -5)};
  const auto files = write_wedge_drawings(folder.path() / "svg", wedges, {}, {.title = "t"});
  ASSERT_TRUE(files);
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ((*files)[1].filename(), "reverse.svg");
  EXPECT_TRUE(read_whole_file((*files)[0], 1U << 20U));
  EXPECT_TRUE(write_wedge_drawings(folder.path() / "none", {}, {}, {.title = "t"})->empty());
  // The reverse's only wedge was none after all.
  ASSERT_EQ(write_wedge_drawings(folder.path() / "svg", {wedges[0]}, {}, {.title = "t"})->size(), 2U);
  EXPECT_THAT(*read_whole_file(folder.path() / "svg" / "reverse.svg", 1U << 20U), Not(HasSubstr("wedge-2")));
}

}  // namespace
}  // namespace dubsar
