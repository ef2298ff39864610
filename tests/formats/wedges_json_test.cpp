// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/wedges_json.h"

#include <cmath>
#include <limits>

#include "formats/file_label_reader.h"
#include "formats/truth_json.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;

TEST(WedgesJson, ReadsBackAllThatWasMeasured) {
  WedgeFile file;
  file.mesh = "tablet.ply";
  file.exits = ExitDefinition::kExtent;
  file.text_from_model = RigidTransform::from_twist({0.1, 0.2, 0.3}, {1, 2, 3});
  file.text_certainty = 0.5;
  Wedge wedge;
  wedge.id = 3;
  wedge.exit_points_surface_mm = {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                  Eigen::Vector3d(0, 0, 1)};
  wedge.exit_points_extent_mm = {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(0, 2, 0),
                                 Eigen::Vector3d(0, 0, 2)};
  wedge.directional_by = DirectionalBy::kFlattest;
  wedge.directional_margin = 0.25;
  wedge.surface_normal = {0, 1, 0};
  wedge.edge_lengths_mm = {3, 2, 1};
  wedge.edge_bows_mm = {0.5, 0, 0};
  wedge.volume_mm3 = 0.125;
  wedge.sigma.depth_point_mm = 0.01;
  wedge.sigma.opening_rad = {0.1, 0.2, 0.3};
  wedge.sigma.face_slope_rad = {0.4, 0.5, 0.6};
  wedge.sigma.edge_slope_rad = {0.7, 0.8, 0.9};
  wedge.sigma.length_mm = {0.25, 0.5, 0.75};
  wedge.sigma.volume_mm3 = 0.75;
  wedge.intact = 0.5;
  wedge.faces_intact = {0.25, 0.5, 0.75};
  wedge.roundness = -0.0625;
  wedge.place = {Face::kReverse, 4, 17, -1.5, 2};
  file.wedges = {wedge, Wedge{}};
  file.rejected = {{"too shallow", {7, 8, 9}}};
  file.former = {{4, {1, 2, 3}, ByHand::kNo}, {9, {4, 5, 6}, ByHand::kMerged}};
  file.timings_s = {{"reading", 0.5}};
  WedgeProfile profile;
  profile.side = Face::kReverse;
  profile.count = 1;
  profile.beyond_mesh = 2;
  profile.kinds[4] = 1;
  profile.quantiles[3][8] = 2.5;
  file.profiles = {profile};
  file.unit_assumed = "m";
  file.spacing_mm = 0.125;
  const std::string text = wedges_to_json(file);
  EXPECT_THAT(text, HasSubstr("\"exit_point_surface\""));
  EXPECT_THAT(text, HasSubstr("\"timings_s\""));
  const auto back = parse_wedges(text, "w");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->mesh, file.mesh);
  EXPECT_EQ(back->exits, ExitDefinition::kExtent);
  ASSERT_TRUE(back->text_from_model);
  EXPECT_EQ(back->text_from_model->translation_mm, Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(back->wedges.size(), 2U);
  const Wedge& w = back->wedges[0];
  EXPECT_EQ(w.exit_points_surface_mm, wedge.exit_points_surface_mm);
  EXPECT_EQ(w.exit_points_extent_mm, wedge.exit_points_extent_mm);
  EXPECT_EQ(w.directional_by, DirectionalBy::kFlattest);
  EXPECT_EQ(w.directional_margin, 0.25);
  EXPECT_EQ(w.edge_lengths_mm, wedge.edge_lengths_mm);
  EXPECT_EQ(w.edge_bows_mm, wedge.edge_bows_mm);
  EXPECT_EQ(w.volume_mm3, 0.125);
  EXPECT_EQ(w.faces_intact, wedge.faces_intact);
  EXPECT_EQ(w.roundness, -0.0625);
  ASSERT_EQ(back->profiles.size(), 1U);
  EXPECT_EQ(back->profiles[0].beyond_mesh, 2);
  EXPECT_NEAR(w.sigma.opening_rad[2], 0.3, 1e-14);
  EXPECT_NEAR(w.sigma.face_slope_rad[1], 0.5, 1e-14);
  EXPECT_NEAR(w.sigma.edge_slope_rad[2], 0.9, 1e-14);
  EXPECT_TRUE(std::isnan(w.sigma.length_mm[1]) && std::isnan(w.sigma.volume_mm3))
      << "nobody knows them of these exits";
  ASSERT_EQ(back->former.size(), 2U);
  EXPECT_EQ(back->former[0].id, 4);
  EXPECT_EQ(back->former[0].by_hand, ByHand::kNo);
  EXPECT_EQ(back->former[1].depth_point_mm, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(back->former[1].by_hand, ByHand::kMerged);
  EXPECT_THAT(line_of(parse_wedges(R"({"wedges":[],"former":[{"id":-1,"depth_point":[0,0,0]}]})", "w")),
              HasSubstr("former[0].id"));
  EXPECT_EQ(parse_wedges(R"({"unit":"m","wedges":[],"former":[{"id":1,"depth_point":[0,0,1]}]})", "w")
                ->former[0]
                .depth_point_mm.z(),
            1000);
  EXPECT_EQ(back->unit_assumed, "m");
  EXPECT_EQ(back->spacing_mm, 0.125);
  file.unit_assumed.clear();
  EXPECT_THAT(wedges_to_json(file), ::testing::Not(HasSubstr("unit_assumed")));
  file.exits = ExitDefinition::kSurface;
  const auto surface = parse_wedges(wedges_to_json(file), "w");
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->wedges[0].sigma.length_mm, wedge.sigma.length_mm);
  EXPECT_EQ(surface->wedges[0].sigma.volume_mm3, 0.75);
  EXPECT_EQ(w.place.side, Face::kReverse);
  EXPECT_EQ(w.place.line, 4);
  EXPECT_EQ(w.place.order, 17);
  EXPECT_EQ(w.place.body, 2);
  EXPECT_FALSE(back->wedges[1].place.side);
  ASSERT_EQ(back->rejected.size(), 1U);
  EXPECT_EQ(back->rejected[0].reason, "too shallow");
  ASSERT_EQ(back->profiles.size(), 1U);
  EXPECT_EQ(back->profiles[0].side, Face::kReverse);
  EXPECT_EQ(back->profiles[0].count, 1);
  EXPECT_EQ(back->profiles[0].kinds, profile.kinds);
  EXPECT_EQ(back->profiles[0].quantiles, profile.quantiles);
  // One of a version with other features is passed over, a broken one is not.
  std::string other = text;
  other.replace(other.find("second_opening_deg"), 6, "fourth");
  ASSERT_TRUE(parse_wedges(other, "w"));
  EXPECT_TRUE(parse_wedges(other, "w")->profiles.empty());
  EXPECT_THAT(line_of(parse_wedges(R"({"wedges":[],"profiles":[{"of":"left side"}]})", "w")),
              HasSubstr("profiles[0].of"));
  // What only the contract asks for is enough.
  EXPECT_TRUE(parse_wedges(truth_to_json({}), "t"));
  EXPECT_THAT(line_of(parse_wedges("{}", "w")), HasSubstr("w: wedges is missing"));
  EXPECT_THAT(line_of(parse_wedges(R"({"exit":"middle","wedges":[]})", "w")), HasSubstr("exit is 'middle'"));
}

TEST(WedgesJson, OfTheContractsKeysAloneTellTheRestOrSayNothing) {
  const std::string text = R"({"unit":"m","wedges":[{"id":1,"depth_point":[0,0,-0.0006],
    "inner_edges":[{"exit_point":[0.0008,0,0]},{"exit_point":[-0.0003,0.0004,0]},{"exit_point":[-0.0003,-0.0004,0]}],
    "directional_edge":0,"outer_vertices":[[0,0,0],[0,0,0],[0,0,0]],"face_normals":[[0,0,1],[0,0,1],[0,0,1]],
    "depth":0.0006,"face_angles_deg":[60,60,60],"opening_angles_deg":[90,90,90],"reliability":1,"confidence":1,
    "vertex_count":9}]})";
  const auto file = parse_wedges(text, "w");
  ASSERT_TRUE(file) << line_of(file);
  const Wedge& w = file->wedges.front();
  EXPECT_NEAR(w.edge_lengths_mm[0], 1.0, 1e-12);
  EXPECT_NEAR(w.edge_slopes_rad[0], std::asin(0.6), 1e-12);
  EXPECT_NEAR(w.volume_mm3, 0.5 * 0.8 * 1.1 / 3 * 0.6, 1e-12);
  EXPECT_EQ(w.exit_points_surface_mm, w.exit_points_mm);
  EXPECT_TRUE(std::isnan(w.sigma.depth_mm));
  EXPECT_TRUE(std::isnan(w.faces_intact[0])) << "nobody said it";
  EXPECT_TRUE(std::isnan(w.sigma.opening_rad[1]));
  EXPECT_TRUE(std::isnan(w.face_slopes_rad[2]));
  const auto again = parse_wedges(wedges_to_json(*file), "w");
  ASSERT_TRUE(again) << line_of(again);
  EXPECT_TRUE(std::isnan(again->wedges.front().sigma.depth_mm));
}

TEST(WedgesJson, AnEdgeThatGoesOnBeyondTheMeshTakesNoSigmaOfTheOthers) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  WedgeFile file;
  Wedge wedge;
  wedge.sigma.length_mm = {0.25, kUnknown, 0.75};
  wedge.sigma.volume_mm3 = kUnknown;
  wedge.beyond_mesh = {false, true, false};
  file.wedges = {wedge};
  const auto back = parse_wedges(wedges_to_json(file), "w");
  ASSERT_TRUE(back) << line_of(back);
  const Wedge& w = back->wedges[0];
  EXPECT_EQ(w.beyond_mesh, wedge.beyond_mesh);
  EXPECT_EQ(w.sigma.length_mm[0], 0.25);
  EXPECT_TRUE(std::isnan(w.sigma.length_mm[1]));
  EXPECT_EQ(w.sigma.length_mm[2], 0.75);
  EXPECT_TRUE(std::isnan(w.sigma.volume_mm3));
}

TEST(WedgesJson, SigmasThatNobodyKnowsAreLeftOutAndMissed) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  WedgeFile file;
  file.exits = ExitDefinition::kExtent;
  Wedge wedge;
  wedge.sigma.depth_mm = 0.02;
  wedge.sigma.edge_rad = {0.1, 0.2, 0.3};
  wedge.sigma.length_mm = {kUnknown, kUnknown, kUnknown};
  wedge.sigma.edge_slope_rad = wedge.sigma.length_mm;  // as in files of before they were written
  wedge.sigma.face_angle_rad = wedge.sigma.length_mm;
  wedge.sigma.volume_mm3 = kUnknown;
  file.wedges = {wedge};
  const std::string text = wedges_to_json(file);
  EXPECT_THAT(text, ::testing::Not(HasSubstr("null")));
  const auto back = parse_wedges(text, "w");
  ASSERT_TRUE(back) << line_of(back);
  const WedgeSigma& sigma = back->wedges[0].sigma;
  EXPECT_EQ(sigma.depth_mm, 0.02);
  EXPECT_NEAR(sigma.edge_rad[1], 0.2, 1e-14);
  EXPECT_TRUE(std::isnan(sigma.length_mm[0]));
  EXPECT_TRUE(std::isnan(sigma.edge_slope_rad[0]));
  EXPECT_TRUE(std::isnan(sigma.face_angle_rad[0])) << "0 would say that it is known for sure";
  EXPECT_TRUE(std::isnan(sigma.volume_mm3));
}

TEST(WedgesJson, VolumesAreCubicMillimetresWhateverTheUnit) {
  WedgeFile file;
  file.wedges = {Wedge{}};
  file.wedges[0].volume_mm3 = 0.125;
  file.wedges[0].sigma.volume_mm3 = 0.02;
  std::string text = wedges_to_json(file);
  text.replace(text.find("\"mm\""), 4, "\"m\"");
  const auto back = parse_wedges(text, "w");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->wedges[0].volume_mm3, 0.125);
  EXPECT_EQ(back->wedges[0].sigma.volume_mm3, 0.02);
}

TEST(WedgesJson, SaysWhatMeasuredThem) {
  WedgeFile file;
  file.program = "Dubsar 9.8.7";
  file.method = 3;
  const std::string text = wedges_to_json(file);
  EXPECT_THAT(text, ::testing::AllOf(HasSubstr("\"program\": \"Dubsar 9.8.7\""), HasSubstr("\"method\": 3")));
  const auto back = parse_wedges(text, "w");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->program, "Dubsar 9.8.7");
  EXPECT_EQ(back->method, 3);
  // Files of before, and of other programs that mean something else by these words.
  for (const char* other :
       {R"({"wedges":[]})", R"({"program":{"name":"x"},"method":"watershed","wedges":[]})",
        R"({"program":7,"method":-3,"wedges":[]})", R"({"method":1e300,"wedges":[]})",
        R"({"method":18446744073709551615,"wedges":[]})", R"({"program":[],"method":2.5,"wedges":[]})"}) {
    const auto read = parse_wedges(other, "w");
    ASSERT_TRUE(read) << other << ": " << line_of(read);
    EXPECT_EQ(read->program, "") << other;
    EXPECT_EQ(read->method, 0) << other;
    EXPECT_THAT(wedges_to_json(*read),
                ::testing::Not(::testing::AnyOf(HasSubstr("program"), HasSubstr("method"))));
  }
}

TEST(WedgesJson, SaysWhatTheWedgesAreOf) {
  WedgeFile file;
  file.label =
      label_of_words({{"SIMULATED", "No such tablet."}, {"Museum number", "BM 1"}, {"Rights", "CC0"}});
  const auto back = parse_wedges(wedges_to_json(file), "w");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->label.name, "BM 1");
  EXPECT_EQ(back->label.rights, "CC0");
  EXPECT_TRUE(back->label.simulated);
  EXPECT_TRUE(parse_wedges(R"({"tablet":"BM 2","wedges":[]})", "w")) << "as another program may say it";
}

}  // namespace
}  // namespace dubsar
