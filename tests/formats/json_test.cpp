// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <limits>

#include "core/units.h"
#include "formats/checklist_json.h"
#include "formats/json_node.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "formats/sign_off_json.h"
#include "formats/truth_json.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::ScratchFolder;

const std::string kIdentity = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";

ScanPose sample_pose(int id) {
  ScanPose pose;
  pose.id = id;
  pose.file = "scan \"" + std::to_string(id) + "\".ply";
  pose.model_from_scanner = RigidTransform::from_twist({0.1 * id, 1.0 / 3, -2}, {1e-7, -1.0 / 7, 1234.5});
  pose.status = PoseStatus::kUnsure;
  pose.rms_mm = 0.1 + 0.2;
  pose.sigma_mm = 1e-3;
  pose.overlap = 2.0 / 3;
  pose.reason = "two ways fit;\nask";
  pose.locked = true;
  pose.covariance = Eigen::Matrix<double, 6, 6>::Constant(1.0 / 9);
  return pose;
}

TEST(PosesJson, ReadsBackToTheBit) {
  std::vector<ScanPose> poses{sample_pose(0), sample_pose(7)};
  poses[1].warning = "its lengths are off";
  poses[1].group_apart = 0;
  const auto back = parse_poses(poses_to_json(poses), "p");
  ASSERT_TRUE(back) << line_of(back);
  ASSERT_EQ(back->size(), 2U);
  const ScanPose& a = poses[1];
  const ScanPose& b = (*back)[1];
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.file, b.file);
  EXPECT_EQ(a.model_from_scanner.row_major(), b.model_from_scanner.row_major());
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.rms_mm, b.rms_mm);
  EXPECT_EQ(a.sigma_mm, b.sigma_mm);
  EXPECT_EQ(a.overlap, b.overlap);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.warning, b.warning);
  EXPECT_EQ(a.locked, b.locked);
  EXPECT_EQ(a.group_apart, b.group_apart);
  EXPECT_EQ(back->front().group_apart, -1);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(poses_to_json(*back), poses_to_json(poses));
}

TEST(PosesJson, KeysStandInTheOrderOfTheContract) {
  const std::string text = poses_to_json(std::vector<ScanPose>{sample_pose(1)});
  std::size_t at = 0;
  for (const char* key : {"\"unit\": \"mm\"", "\"frame\": \"model\"", "\"scans\"", "\"id\"", "\"file\"",
                          "\"model_from_scanner\"", "\"status\": \"unsure\"", "\"rms_mm\"", "\"sigma_mm\"",
                          "\"overlap\"", "\"reason\""}) {
    const std::size_t found = text.find(key, at);
    ASSERT_NE(found, std::string::npos) << key;
    at = found;
  }
}

TEST(PosesJson, NeedsLittle) {
  const auto by_file =
      parse_poses(R"({"scans":[{"file":"a.ply","model_from_scanner":)" + kIdentity + "}]}", "p");
  ASSERT_TRUE(by_file) << line_of(by_file);
  EXPECT_EQ(by_file->front().id, -1);
  EXPECT_EQ(by_file->front().status, PoseStatus::kRegistered);
  EXPECT_TRUE(parse_poses(poses_to_json(*by_file), "again"))
      << "a pose known by its file alone is written so";
  const auto in_metres = parse_poses(
      R"({"unit":"m","scans":[{"id":3,"model_from_scanner":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]})", "p");
  ASSERT_TRUE(in_metres) << line_of(in_metres);
  EXPECT_EQ(in_metres->front().model_from_scanner.translation_mm.x(), 500);
}

TEST(PosesJson, PutsARoundedRotationBackOntoSo3) {
  const auto poses = parse_poses(
      R"({"scans":[{"id":0,"model_from_scanner":[0.8660,-0.5,0,1, 0.5,0.8660,0,2, 0,0,1,3, 0,0,0,1]}]})",
      "p");
  ASSERT_TRUE(poses) << line_of(poses);
  EXPECT_TRUE(poses->front().model_from_scanner.is_rigid(1e-12));
}

TEST(PosesJson, AFailedPoseThatIsNoTransformStillReadsBack) {
  ScanPose pose = sample_pose(2);
  pose.status = PoseStatus::kFailed;
  pose.model_from_scanner.translation_mm.x() = std::numeric_limits<double>::quiet_NaN();
  pose.rms_mm = std::numeric_limits<double>::infinity();
  const auto back = parse_poses(poses_to_json(std::vector{pose}), "p");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->front().status, PoseStatus::kFailed);
}

TEST(PosesJson, NamesWhatIsWrongByItsPath) {
  const auto line = [](const std::string& text) { return line_of(parse_poses(text, "p.json")); };
  const auto scan = [&](const std::string& inside) { return line(R"({"scans":[{"id":0,)" + inside + "}]}"); };
  EXPECT_THAT(line(""), HasSubstr("p.json: the file is empty"));
  EXPECT_THAT(line("{\n\"scans\": [}"), HasSubstr("p.json: line 2: not JSON from byte"));
  EXPECT_THAT(line("[]"), HasSubstr("the document is an array, not an object"));
  EXPECT_THAT(line("{}"), HasSubstr("p.json: scans is missing; give poses as docs/formats/poses.md"));
  EXPECT_THAT(line(R"({"scans":3})"), HasSubstr("scans is a number, not an array"));
  EXPECT_THAT(line(R"({"scans":[4]})"), HasSubstr("scans[0] has neither id nor file"));
  EXPECT_THAT(line(R"({"unit":"ell","scans":[]})"), HasSubstr("unit is not m, cm, mm, um or in"));
  EXPECT_THAT(line(R"({"scans":[{"id":0}]})"), HasSubstr("scans[0].model_from_scanner is missing"));
  EXPECT_THAT(line(R"({"scans":[{"id":-1}]})"), HasSubstr("scans[0].id is -1, out of range"));
  EXPECT_THAT(line(R"({"scans":[{"id":1.5}]})"), HasSubstr("scans[0].id is 1.5, not a whole number"));
  EXPECT_THAT(scan(R"("model_from_scanner":[1,2])"),
              HasSubstr("scans[0].model_from_scanner has 2 entries, not 16"));
  EXPECT_THAT(scan(R"("model_from_scanner":[1,0,0,0, 0,1,0,"x", 0,0,1,0, 0,0,0,1])"),
              HasSubstr("scans[0].model_from_scanner[7] is text, not a number"));
  for (const char* bad : {"[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]", "[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]",
                          "[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]"}) {
    EXPECT_THAT(scan(std::string(R"("model_from_scanner":)") + bad), HasSubstr("is not a rigid transform"))
        << bad;
  }
  EXPECT_THAT(scan(R"("status":"fine","model_from_scanner":)" + kIdentity),
              HasSubstr("scans[0].status is 'fine', none of registered, unsure, failed"));
  EXPECT_THAT(scan(R"("rms_mm":1e999,"model_from_scanner":)" + kIdentity),
              HasSubstr("a number in it is too large"));
  EXPECT_THAT(line(std::string(100000, '[')), HasSubstr("nested deeper than 64 levels"));
}

TEST(JsonDepth, CountsBracketsOutsideOfStrings) {
  EXPECT_EQ(json_depth(""), 0);
  EXPECT_EQ(json_depth("[]"), 1);
  EXPECT_EQ(json_depth(R"({"a":[{}],"b":[]})"), 3);
  EXPECT_EQ(json_depth(R"(["[[[", "\"[[", {}])"), 2);
  EXPECT_EQ(json_depth(std::string(100000, '[')), 100000);
}

TEST(PosesJson, WritesAFile) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_poses(folder / "poses.json", std::vector{sample_pose(0)}));
  EXPECT_EQ(read_poses(folder / "poses.json").value().size(), 1U);
}

TEST(PinsJson, ReadsBack) {
  PinSet pins;
  pins.tip_diameter_mm = 1.1;
  pins.tips[4] = {{3, {1.0 / 3, 2, -3}}, {-1, {0, 0, 0}}};
  pins.tips[5] = {};
  const auto back = parse_pins(pins_to_json(pins), "p");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->tip_diameter_mm, 1.1);
  ASSERT_EQ(back->tips.size(), 2U);
  EXPECT_EQ(back->tips.at(4)[0].label, 3);
  EXPECT_EQ(back->tips.at(4)[0].position_mm, pins.tips[4][0].position_mm);
  EXPECT_EQ(back->tips.at(4)[1].label, -1);
}

TEST(PinsJson, NamesWhatIsWrong) {
  EXPECT_TRUE(parse_pins(R"({"tip_diameter_mm":1.0})", "p").value().tips.empty());
  const auto line = [](const std::string& text) { return line_of(parse_pins(text, "p")); };
  EXPECT_THAT(line("{}"), HasSubstr("p: tip_diameter_mm is missing"));
  EXPECT_THAT(line(R"({"tip_diameter_mm":-1})"), HasSubstr("tip_diameter_mm is -1, out of range"));
  EXPECT_THAT(line(R"({"tip_diameter_mm":1,"scans":[{"id":0,"tips":[{"label":1}]}]})"),
              HasSubstr("scans[0].tips[0].position is missing"));
  EXPECT_THAT(line(R"({"tip_diameter_mm":1,"scans":[{"id":0,"tips":[]},{"id":0,"tips":[]}]})"),
              HasSubstr("scans[1] has the id of an earlier scan"));
  EXPECT_THAT(line(R"({"tip_diameter_mm":1,"scans":[{"id":0,"tips":[{"label":1,"position":[1,2,3]},
                      {"label":1,"position":[1,2,3]}]}]})"),
              HasSubstr("scans[0].tips[1].label stands twice in one scan"));
}

RedMap sample_red_map() {
  RedMap map;
  map.scans = {{0, 100, 20, 10, 5, 1}, {2, 50000000000, 0, 0, 0, 0}};
  map.copies = {{5, 0}, {7, 2}};
  RedRegion red;
  red.face = Face::kBottom;
  red.center_mm = {1.0 / 3, -2, 3};
  red.normal = {0, 0.6, 0.8};
  red.area_mm2 = 12.5;
  red.reason = "gives no signal";
  RedRegion excused = red;
  excused.state = RegionState::kExcused;
  excused.excuse = Excuse::kUnneeded;
  excused.reason = "smooth to 11 µm";
  map.regions = {red, excused};
  NextView view;
  view.model_from_scanner = RigidTransform::from_twist({1, 2, 3}, {4, 5, 6});
  view.predicted_cleared_mm2 = 3.25;
  view.say = "turn the top edge towards the camera, 40°";
  view.placement =
      Placement{rad_from_deg(40), rad_from_deg(15), RigidTransform::from_twist({0, 1, 0}, {0, 0, 0})};
  map.next = {view, NextView{}};
  map.apart = {{{3, 5}, "scans 3 and 5 fit one another"}};
  return map;
}

TEST(RedMapJson, ReadsBack) {
  const RedMap map = sample_red_map();
  const std::string text = red_map_to_json(map);
  const auto back = parse_red_map(text, "r");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->scans[1].samples, 50000000000);
  EXPECT_EQ(back->copies, map.copies);
  EXPECT_EQ(red_map_to_json(RedMap{}).find("copies"), std::string::npos);
  ASSERT_EQ(back->apart.size(), 1U);
  EXPECT_EQ(back->apart[0].ids, map.apart[0].ids);
  EXPECT_EQ(back->apart[0].say, map.apart[0].say);
  EXPECT_EQ(red_map_to_json(RedMap{}).find("groups_apart"), std::string::npos);
  EXPECT_EQ(back->regions[0].reason, map.regions[0].reason);
  EXPECT_EQ(back->regions[1].reason, map.regions[1].reason);
  EXPECT_EQ(back->regions[1].excuse, Excuse::kUnneeded);
  EXPECT_EQ(back->regions[0].excuse, Excuse::kNone);
  EXPECT_EQ(back->regions[0].face, Face::kBottom);
  EXPECT_EQ(back->regions[0].center_mm, map.regions[0].center_mm);
  ASSERT_TRUE(back->next[0].placement);
  EXPECT_NEAR(back->next[0].placement->turntable_rad, rad_from_deg(40), 1e-12);
  EXPECT_FALSE(back->next[1].placement);
  EXPECT_EQ(red_map_to_json(*back), text);
}

TEST(RedMapJson, NamesWhatIsWrong) {
  const auto line = [](const std::string& text) { return line_of(parse_red_map(text, "r")); };
  EXPECT_THAT(line("{}"), HasSubstr("r: conclusive is missing"));
  EXPECT_THAT(line(R"({"conclusive":1})"), HasSubstr("conclusive is a number, not true or false"));
  EXPECT_THAT(line(R"({"conclusive":true,"scans":[],"regions":[{"face":"front"}],"next":[]})"),
              HasSubstr("regions[0].face is 'front', none of obverse"));
  EXPECT_THAT(line(R"({"conclusive":true,"scans":[],"regions":[{"face":"left","center":[0,0,0],"area_mm2":1,
                      "state":"excused"}],"next":[]})"),
              HasSubstr("regions[0] is excused but has no excuse"));
}

TEST(TruthJson, ReadsBackInDegreesAtTheSurface) {
  TabletTruth truth;
  truth.mesh = "tablet.ply";
  truth.seed = 0xfedcba9876543210ULL;
  truth.size_mm = {50, 40, 20};
  truth.spacing_mm = 0.1;
  Wedge wedge;
  wedge.id = 9;
  wedge.depth_point_mm = {1, 2, 1.0 / 3};
  wedge.exit_points_mm = {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)};
  wedge.outer_vertices_mm = wedge.exit_points_mm;
  wedge.face_normals = wedge.exit_points_mm;
  wedge.directional_edge = 2;
  wedge.depth_mm = 0.8;
  wedge.face_angles_rad = {rad_from_deg(60), 1, 1.1};
  wedge.opening_angles_rad = {1.2, 1.3, 1.4};
  wedge.reliability = 0.5;
  wedge.confidence = 1;
  wedge.vertex_count = 77;
  wedge.intact = 0.9;
  truth.wedges = {wedge};
  const std::string text = truth_to_json(truth);
  EXPECT_THAT(text, HasSubstr("\"exit_point\""));
  EXPECT_THAT(text, HasSubstr("\"face_angles_deg\": [\n    59.9999") /* 60° in binary */);
  const auto back = parse_truth(text, "t");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->seed, truth.seed);
  EXPECT_EQ(back->size_mm, truth.size_mm);
  const Wedge& w = back->wedges.front();
  EXPECT_EQ(w.depth_point_mm, wedge.depth_point_mm);
  EXPECT_EQ(w.exit_points_mm, wedge.exit_points_mm);
  EXPECT_EQ(w.directional_edge, 2);
  EXPECT_NEAR(w.opening_angles_rad[2], 1.4, 1e-14);
  EXPECT_EQ(w.intact, 0.9);
  EXPECT_THAT(line_of(parse_truth(R"({"wedges":[{"id":0,"depth_point":[0,0,0],"inner_edges":[]}]})", "t")),
              HasSubstr("t: wedges[0].inner_edges has 0 entries, not 3"));
}

TEST(ChecklistJson, ReadsBack) {
  Checklist checklist;
  checklist.faces[3].seen_mm2 = 1.0 / 3;
  checklist.faces[3].interpolated_mm2 = 0.25;
  checklist.faces[3].red_regions_mm2 = {2, 1};
  checklist.faces[3].sampling.places = 12;
  checklist.faces[3].sampling.spacing_mm.median = 0.061;
  checklist.faces[3].sampling.scans_share[5] = 0.5;
  checklist.strays = 3;
  checklist.worst_sigma_scan = 4;
  checklist.worst_sigma_mm = 0.0125;
  checklist.warnings = {{2, "it is 2.0 % too long"}};
  checklist.remarks = {{4, "its header says another spacing"}};
  checklist.calibration_check = {"2026-01-02", "ball bar 7", 0.012};
  checklist.store_checked = "2026-01-02T03:04:05Z";
  checklist.store_files = 31;
  checklist.scans_unsure = 2;
  checklist.scans_lost = {0, 7};
  checklist.scans_unplaced = {5, 8};
  checklist.calibration = "bar 17";
  checklist.calibration_age_days = 3.5;
  checklist.disk_free_gib = 12.25;
  checklist.store_whole = true;
  const auto back = parse_checklist(checklist_to_json(checklist), "c");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->faces[3].seen_mm2, 1.0 / 3);
  EXPECT_EQ(back->faces[3].sampling.spacing_mm.median, 0.061);
  EXPECT_TRUE(std::isinf(back->faces[3].sampling.spacing_mm.p95)) << "null: not sampled so far";
  ASSERT_EQ(back->warnings.size(), 1U);
  EXPECT_EQ(back->warnings[0].scan, 2);
  EXPECT_EQ(back->warnings[0].text, "it is 2.0 % too long");
  EXPECT_EQ(back->scans_lost, checklist.scans_lost);
  EXPECT_EQ(back->scans_unplaced, checklist.scans_unplaced);
  ASSERT_EQ(back->remarks.size(), 1U);
  EXPECT_EQ(back->remarks[0].scan, 4);
  EXPECT_EQ(back->remarks[0].text, "its header says another spacing");
  EXPECT_EQ(back->calibration_age_days, 3.5);
  EXPECT_EQ(back->calibration_check->artefact, "ball bar 7");
  EXPECT_EQ(checklist_to_json(*back), checklist_to_json(checklist));
  EXPECT_THAT(line_of(parse_checklist(R"({"conclusive":true,"faces":{}})", "c")),
              HasSubstr("c: faces.obverse is missing"));
}

TEST(ChecklistJson, ReadsTheShortOneOfEarlierSessions) {
  std::string faces;
  for (const char* face : {"obverse", "reverse", "left", "right", "top", "bottom"}) {
    faces += (faces.empty() ? "\"" : ",\"") + std::string(face) +
             R"(":{"seen_mm2":5.5,"red_mm2":0,"excused_mm2":0.25})";
  }
  const auto list = parse_checklist(
      R"({"conclusive":true,"faces":{)" + faces +
          R"(},"scans_registered":2,"scans_unsure":0,"scans_failed":0,"calibration":"","disk_free_gib":1,)" +
          R"("store_whole":true})",
      "c");
  ASSERT_TRUE(list) << line_of(list);
  EXPECT_EQ(list->faces[0].excused_mm2, 0.25);
  EXPECT_EQ(list->sampling.places, 0);
}

TEST(SignOffJson, ReadsBack) {
  RecordedSignOff recorded;
  recorded.sign_off = {3,     "A. Reader",  "conservator",  "a \"note\"", "2026-01-02T03:04:05Z",
                       false, "one corner", "Dubsar 0.1.0", "ab12"};
  recorded.manifest = "dubsar sign-off 1\nverdict not conclusive\n";
  const auto back = parse_recorded_sign_off(recorded_sign_off_to_json(recorded), "s");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->manifest, recorded.manifest);
  EXPECT_EQ(back->sign_off.incomplete, "one corner");
  EXPECT_EQ(recorded_sign_off_to_json(*back), recorded_sign_off_to_json(recorded));
  EXPECT_THAT(line_of(parse_recorded_sign_off(R"({"number":0})", "s")), HasSubstr("s: number"));
}

}  // namespace
}  // namespace dubsar
