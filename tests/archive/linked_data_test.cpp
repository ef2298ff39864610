// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is written for other programs: the table of wedges, annotations, manifest, provenance.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "archive/canvas_annotations.h"
#include "archive/file_address.h"
#include "archive/iiif_manifest.h"
#include "archive/provenance.h"
#include "archive/rights.h"
#include "archive/wedge_annotations.h"
#include "archive/wedge_table.h"
#include "core/units.h"

namespace dubsar {
namespace {

using ::testing::StartsWith;

Wedge some_wedge() {
  Wedge wedge;
  wedge.id = 7;
  wedge.depth_point_mm = {1.5, -2, 3};
  wedge.outer_vertices_mm = {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 2, 0), Eigen::Vector3d(0, 0, 3)};
  wedge.depth_mm = 0.75;
  wedge.place = {Face::kReverse, 2, 3, 0};
  wedge.sigma.volume_mm3 = std::numeric_limits<double>::infinity();
  return wedge;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    out.push_back(cell);
  }
  return out;
}

/// Of a table of one line: its cell by that name.
std::function<std::string(const std::string&)> value_in(const std::string& csv) {
  const std::size_t end = csv.find("\r\n");
  const auto names = cells(csv.substr(0, end));
  const auto values = cells(csv.substr(end + 2, csv.size() - end - 4));
  EXPECT_EQ(names.size(), values.size());
  return [names, values](const std::string& name) {
    const auto at = std::ranges::find(names, name);
    return at == names.end() ? "no such name" : values[static_cast<std::size_t>(at - names.begin())];
  };
}

TEST(WedgeTable, HasANameForEveryCell) {
  const auto value = value_in(wedge_table({some_wedge()}, {.name = "BM 1"}));
  EXPECT_EQ(value("id"), "7");
  EXPECT_EQ(value("side"), "reverse");
  EXPECT_EQ(value("line"), "2");
  EXPECT_EQ(value("depth_point_x_mm"), "1.5");
  EXPECT_EQ(value("depth_mm"), "0.75");
  EXPECT_EQ(value("directional_by"), "longest and flattest");
  EXPECT_EQ(value("sigma_volume_mm3"), "") << "what is not known is empty";
  EXPECT_EQ(value("turn_deg"), "0");
}

TEST(WedgeWords, ATurnOfHardlyAnythingIsNoughtWithoutASign) {
  Wedge wedge = some_wedge();
  wedge.place.turn_rad = rad_from_deg(-0.3);
  EXPECT_THAT(wedge_in_words(wedge), ::testing::HasSubstr(" at 0 degrees as the side is read"));
}

TEST(WedgeTable, HoldsEveryMeasureAndKeepsTheMicrometre) {
  Wedge far = some_wedge();
  far.depth_point_mm = {12345.6789, 0, 0};  // a mesh that lies twelve metres from its origin
  far.place = {};
  far.face_normals[2] = {0, 0.6, 0.8};
  far.exit_points_extent_mm[1] = {1, 2, 3.25};
  far.sigma.depth_point_mm = 0.0125;
  far.sigma.edge_rad = {0, rad_from_deg(1.5), 0};
  far.sigma.edge_slope_rad = {0, 0, rad_from_deg(1.75)};
  far.sigma.face_angle_rad = {0, 0, rad_from_deg(2.5)};
  far.sigma.face_slope_rad = {rad_from_deg(0.5), 0, 0};
  const auto value = value_in(wedge_table({far}, {.name = "BM 1"}));
  EXPECT_EQ(value("depth_point_x_mm"), "12345.6789");
  EXPECT_EQ(value("turn_deg"), "") << "nobody knows its side";
  EXPECT_EQ(value("face_normal_2_z"), "0.8");
  EXPECT_EQ(value("exit_point_extent_1_z_mm"), "3.25");
  EXPECT_EQ(value("sigma_depth_point_mm"), "0.0125");
  EXPECT_EQ(value("sigma_edge_1_deg"), "1.5");
  EXPECT_EQ(value("sigma_edge_slope_2_deg"), "1.75");
  EXPECT_EQ(value("sigma_face_angle_2_deg"), "2.5");
  EXPECT_EQ(value("sigma_face_slope_0_deg"), "0.5");
}

TEST(WedgeTable, TellsOnEveryLineWhatTheWedgesAreOf) {
  const FileLabel label{.name = "P000001, BM 12345",
                        .rights = "© A \"Museum\"; CC0\nand more",
                        .simulated = true,
                        .words = {{"Collection", "Kouyunjik"}}};
  const std::string csv = wedge_table({some_wedge(), some_wedge()}, label);
  EXPECT_NE(csv.find(",by_hand,tablet,collection,rights,simulated\r\n"), std::string::npos);
  const std::string end = R"(,"P000001, BM 12345",Kouyunjik,"© A ""Museum""; CC0 and more",yes)"
                          "\r\n";
  const std::size_t first = csv.find(end);
  ASSERT_NE(first, std::string::npos) << csv;
  EXPECT_EQ(csv.find(end, first + 1), csv.size() - end.size());
  EXPECT_TRUE(wedge_table({some_wedge()}, {}).ends_with(",,,\r\n"))
      << "of a mesh that says nothing of itself";
  EXPECT_TRUE(wedge_table({some_wedge()}, {.name = "BM 1"}).ends_with(",BM 1,,,no\r\n"));
}

TEST(WedgeTable, HoldsNothingThatASpreadsheetRuns) {
  const auto last_cells = [](const char* name, const char* collection, const char* rights) {
    Wedge wedge = some_wedge();
    wedge.depth_point_mm.x() = -1.25;  // a number stays one
    const std::string csv =
        wedge_table({wedge}, {.name = name, .rights = rights, .words = {{"Collection", collection}}});
    EXPECT_NE(csv.find(",-1.25,"), std::string::npos) << csv;
    return csv.substr(csv.rfind("no,") + 3);
  };
  EXPECT_EQ(last_cells("=1+1", "=HYPERLINK(\"http://x\")", "+cmd"),
            "'=1+1,\"'=HYPERLINK(\"\"http://x\"\")\",'+cmd,no\r\n");
  EXPECT_EQ(last_cells("-2", "@SUM(A1)", "\t=1"), "'-2,'@SUM(A1),' =1,no\r\n");
  EXPECT_EQ(last_cells("BM 1=2", "A-B", "a@b"), "BM 1=2,A-B,a@b,no\r\n");
}

TEST(WedgeAnnotations, PointAtAClosedRingOnTheModel) {
  const auto page = nlohmann::json::parse(
      wedge_annotations({some_wedge()}, {"https://example.org/t/", "wedges/annotations.json", "model/t.ply",
                                         "BM 1", "Dubsar", "2026-01-02T03:04:05Z"}));
  EXPECT_EQ(page["type"], "AnnotationPage");
  const std::string address = "https://example.org/t/wedges/annotations.json";
  EXPECT_EQ(page["id"], address);
  EXPECT_THAT(page["items"][0]["id"].get<std::string>(), ::testing::StartsWith(address + "#wedge-"));
  const auto& target = page["items"][0]["target"];
  EXPECT_EQ(target["source"], "https://example.org/t/model/t.ply");
  EXPECT_EQ(target["selector"]["value"],
            "POLYGON Z ((1.0000 0.0000 0.0000, 0.0000 2.0000 0.0000, 0.0000 0.0000 3.0000, 1.0000 0.0000 "
            "0.0000))");
}

TEST(WedgeAnnotations, SayByWhatTheTailsTurnGoes) {
  Wedge wedge = some_wedge();
  wedge.edge_lengths_mm[0] = 1.25;
  wedge.place = {Face::kLeft, 1, 2, rad_from_deg(41)};
  EXPECT_THAT(wedge_in_words(wedge),
              ::testing::HasSubstr("directional edge 1.25 mm long at 41 degrees as the side is read, "));
  wedge.place = {};
  EXPECT_THAT(wedge_in_words(wedge), ::testing::HasSubstr("directional edge 1.25 mm long, confidence"));
  wedge.beyond_mesh[0] = true;
  wedge.exit_points_surface_mm = wedge.exit_points_mm;
  EXPECT_THAT(wedge_in_words(wedge),
              ::testing::HasSubstr("1.25 mm long (the mesh ends before it: not measured), confidence"));
  wedge.exit_points_surface_mm[0] += Eigen::Vector3d(1, 0, 0);
  EXPECT_THAT(wedge_in_words(wedge), ::testing::HasSubstr("1.25 mm long, confidence"))
      << "it is measured to where the edge was seen last";
}

TEST(WedgeAnnotations, SayThatNoClayWasMeasured) {
  AnnotationSource source{"https://example.org/t/", "a.json", "t.ply", "BM 1", "Dubsar",
                          "2026-01-02T03:04:05Z"};
  EXPECT_EQ(nlohmann::json::parse(wedge_annotations({}, source))["label"], "Wedges of BM 1");
  source.simulated = "Made up.";
  EXPECT_EQ(nlohmann::json::parse(wedge_annotations({}, source))["label"],
            "SIMULATED. Wedges of BM 1. Made up.");
  EXPECT_EQ(nlohmann::json::parse(canvas_annotations({}, {}, {}, source))["label"]["en"][0],
            "SIMULATED. Wedges of BM 1. Made up.");
}

TEST(CanvasAnnotations, PointAtAPartOfTheCanvas) {
  const WedgeOnPicture on{
      0, {Eigen::Vector2d(10.25, 20), Eigen::Vector2d(30, 20.5), Eigen::Vector2d(-1.04, 41)}};
  AnnotationSource source{"https://example.org/t/", "iiif/annotations/3.json", "", "BM 1", "Dubsar",
                          "2026-01-02T03:04:05Z"};
  source.rights = "© A Museum; CC0 (https://creativecommons.org/publicdomain/zero/1.0/)";
  const auto page = nlohmann::json::parse(
      canvas_annotations({some_wedge()}, {on}, {canvas_id("https://example.org/t/", 2), 100, 40}, source));
  EXPECT_EQ(page["id"], "https://example.org/t/iiif/annotations/3.json");
  EXPECT_EQ(page["rights"], "http://creativecommons.org/publicdomain/zero/1.0/");
  EXPECT_EQ(page["requiredStatement"]["value"]["none"][0], source.rights);
  const auto& item = page["items"][0];
  EXPECT_EQ(item["id"], "https://example.org/t/iiif/annotations/3.json#wedge-7");
  EXPECT_THAT(item["body"]["value"].get<std::string>(),
              StartsWith("Wedge 7 on the reverse, line 2, number 3"));
  EXPECT_EQ(item["target"]["source"]["id"], "https://example.org/t/iiif/canvas/3");
  const auto& selectors = item["target"]["selector"];
  EXPECT_EQ(selectors[0]["value"], "xywh=0,20,30,20") << "what lies on the canvas, in whole pixels";
  EXPECT_EQ(selectors[1]["value"],
            R"(<svg xmlns="http://www.w3.org/2000/svg"><path d="M10.2 20.0L30.0 20.5L-1.0 41.0Z"/></svg>)");
}

TEST(CanvasAnnotations, OfAWedgeInTwoViewsOfOneSheetHaveTwoIds) {
  const std::array<Eigen::Vector2d, 3> corners = {Eigen::Vector2d(1, 2), Eigen::Vector2d(3, 2),
                                                  Eigen::Vector2d(1, 4)};
  const auto page = nlohmann::json::parse(canvas_annotations(
      {some_wedge()}, {{0, corners, Face::kObverse}, {0, corners, Face::kLeft}}, {"c", 100, 40},
      {"https://example.org/t/", "a.json", "", "BM 1", "Dubsar", "2026-01-02T03:04:05Z"}));
  EXPECT_EQ(page["items"][0]["id"], "https://example.org/t/a.json#wedge-7-obverse");
  EXPECT_EQ(page["items"][1]["id"], "https://example.org/t/a.json#wedge-7-left");
}

TEST(IiifManifest, NamesThePageOfAnnotationsOfACanvas) {
  ManifestInput input;
  input.base_url = "https://example.org/t/";
  input.pictures = {{"a.png", "Obverse", "image/png", 300, 200, 0.05},
                    {"b.png", "Reverse", "image/png", 300, 200, 0.05, "iiif/annotations/2.json"}};
  const auto manifest = nlohmann::json::parse(iiif_manifest(input));
  EXPECT_FALSE(manifest["items"][0].contains("annotations"));
  EXPECT_EQ(manifest["items"][1]["id"], canvas_id(input.base_url, 1));
  EXPECT_EQ(manifest["items"][1]["annotations"],
            nlohmann::json::parse(
                R"([{"id":"https://example.org/t/iiif/annotations/2.json","type":"AnnotationPage"}])"));
}

TEST(IiifManifest, HasACanvasAPictureWithItsScale) {
  ManifestInput input;
  input.base_url = "https://example.org/t/";
  input.label = "BM 1";
  input.metadata = {{"Museum number", "BM 1"}, {"CDLI number", ""}};
  input.pictures = {{"a.png", "Obverse", "image/png", 300, 200, 0.05},
                    {"b.jpg", "All", "image/jpeg", 9, 8, 0}};
  const auto manifest = nlohmann::json::parse(iiif_manifest(input));
  ASSERT_EQ(manifest["items"].size(), 2U);
  const auto& canvas = manifest["items"][0];
  EXPECT_EQ(canvas["width"], 300);
  EXPECT_EQ(canvas["items"][0]["items"][0]["body"]["id"], "https://example.org/t/a.png");
  EXPECT_EQ(canvas["items"][0]["items"][0]["target"], canvas["id"]);
  EXPECT_DOUBLE_EQ(canvas["service"][0]["physicalScale"].get<double>(), 0.005);
  EXPECT_FALSE(manifest["items"][1].contains("service")) << "not to scale";
  EXPECT_EQ(manifest["metadata"].size(), 1U);
}

TEST(Rights, TheAddressIsFoundInTheSentence) {
  EXPECT_EQ(rights_address("CC BY 4.0 (https://creativecommons.org/licenses/by/4.0/), the museum"),
            "https://creativecommons.org/licenses/by/4.0/");
  EXPECT_EQ(rights_address("see http://museum.example/rights."), "http://museum.example/rights");
  EXPECT_EQ(rights_address("all rights reserved"), "");
  EXPECT_EQ(rights_address("https://"), "");
}

TEST(Rights, ForIiifAreLicencesAndStatementsByTheirOwnAddress) {
  for (const auto& [said, address] :
       {std::pair{"In copyright, https://rightsstatements.org/page/InC/1.0/?language=en",
                  "http://rightsstatements.org/vocab/InC/1.0/"},
        std::pair{"http://rightsstatements.org/vocab/InC-EDU/1.0/",
                  "http://rightsstatements.org/vocab/InC-EDU/1.0/"},
        std::pair{"CC BY (https://creativecommons.org/licenses/by/4.0/#text)",
                  "http://creativecommons.org/licenses/by/4.0/"},
        std::pair{"https://creativecommons.org/publicdomain/mark/1.0/",
                  "http://creativecommons.org/publicdomain/mark/1.0/"},
        std::pair{"CC BY-SA 4.0, https://creativecommons.org/licenses/by-sa/4.0/deed.de",
                  "http://creativecommons.org/licenses/by-sa/4.0/"},
        std::pair{"https://creativecommons.org/licenses/by/3.0/de/legalcode",
                  "http://creativecommons.org/licenses/by/3.0/de/"},
        std::pair{"CC BY 4.0: https://creativecommons.org/licenses/by/4.0.",
                  "http://creativecommons.org/licenses/by/4.0/"},
        std::pair{"https://rightsstatements.org/vocab/CNE/1.0", "http://rightsstatements.org/vocab/CNE/1.0/"},
        std::pair{"https://creativecommons.org/licenses/deed.en", ""}, std::pair{"no address", ""},
        std::pair{"https://creativecommons.org/", ""}, std::pair{"https://creativecommons.org/licenses/", ""},
        std::pair{"https://creativecommons.org/about/cclicenses/", ""},
        std::pair{"https://rightsstatements.org/en/statements/", ""},
        std::pair{"https://rightsstatements.org/page/", ""},
        std::pair{"https://rightsstatements.org.example/vocab/InC/1.0/", ""},
        std::pair{"http://museum.example/?of=http://creativecommons.org/licenses/by/4.0/", ""}}) {
    EXPECT_EQ(iiif_rights(said), address) << said;
  }
}

TEST(Rights, GoWithPicturesAndAnnotations) {
  ManifestInput input;
  input.base_url = "https://example.org/t/";
  EXPECT_FALSE(nlohmann::json::parse(iiif_manifest(input)).contains("requiredStatement"));
  input.rights = "CC BY 4.0, https://creativecommons.org/licenses/by/4.0/";
  auto manifest = nlohmann::json::parse(iiif_manifest(input));
  EXPECT_EQ(manifest["rights"], "http://creativecommons.org/licenses/by/4.0/");
  EXPECT_EQ(manifest["requiredStatement"]["value"]["none"][0], input.rights);
  input.rights = "https://museum.example/rights";
  manifest = nlohmann::json::parse(iiif_manifest(input));
  EXPECT_FALSE(manifest.contains("rights")) << "IIIF takes those of two bodies only";
  EXPECT_EQ(manifest["requiredStatement"]["value"]["none"][0], input.rights);
  AnnotationSource source{"https://example.org/t/", "a.json", "t.ply", "BM 1", "Dubsar",
                          "2026-01-02T03:04:05Z"};
  EXPECT_FALSE(nlohmann::json::parse(wedge_annotations({some_wedge()}, source)).contains("rights"));
  source.rights = input.rights;
  EXPECT_EQ(nlohmann::json::parse(wedge_annotations({some_wedge()}, source))["rights"], input.rights);
}

TEST(Provenance, SaysWhoSignedAndWhenScansWithoutATimeWereStored) {
  ProvenanceInput input;
  input.base_url = "https://example.org/t/";
  input.program = "Dubsar";
  input.scans = {{0, "2026-11-27T23:07:05Z", "", "registered", true, {}, true},
                 {1, "2026-11-27T23:08:05Z", "", "registered", true, {}}};
  input.signatures = {
      {"A. Reader", "conservator", "2026-11-27T23:09:00Z", "it holds", {"verdict/red_map.json"}}};
  const auto json = nlohmann::json::parse(provenance_jsonld(input));
  const auto find = [&](const std::string& id) {
    for (const auto& node : json["@graph"]) {
      if (node["@id"] == input.base_url + id) {
        return node;
      }
    }
    return nlohmann::json();
  };
  const auto stored = find("provenance/scan-0")["crm:P4_has_time-span"];
  EXPECT_EQ(stored["crm:P82b_end_of_the_end"]["@value"], "2026-11-27T23:07:05Z");
  EXPECT_FALSE(stored.contains("crm:P82a_begin_of_the_begin")) << "nobody says when it began";
  EXPECT_TRUE(find("provenance/scan-1")["crm:P4_has_time-span"].contains("crm:P82a_begin_of_the_begin"));
  const auto signing = find("provenance/signature-1");
  EXPECT_EQ(signing["@type"], "crm:E7_Activity");
  EXPECT_EQ(signing["crm:P4_has_time-span"]["crm:P82b_end_of_the_end"]["@value"], "2026-11-27T23:09:00Z");
  EXPECT_EQ(signing["crm:P16_used_specific_object"][0]["@id"], "https://example.org/t/verdict/red_map.json");
  EXPECT_EQ(signing["crm:P3_has_note"], "it holds");
  const auto person = find(signing["crm:P14_carried_out_by"]["@id"].get<std::string>().substr(22));
  EXPECT_EQ(person["rdfs:label"], "A. Reader");
  EXPECT_EQ(person["crm:P3_has_note"], "conservator");
}

TEST(Provenance, NamesFilesByAddressesThatHoldTheirNames) {
  ProvenanceInput input;
  input.base_url = "https://example.org/t/";
  input.program = "Dubsar";
  ProvenanceStep packing;
  packing.name = "packing";
  packing.made = {"kept/mesh/old model #2, 50%.ply", "model/BM_1.draco.glb"};
  input.steps = {packing};
  const auto json = nlohmann::json::parse(provenance_jsonld(input));
  std::vector<std::string> made;
  for (const auto& node : json["@graph"]) {
    if (node["@id"] == "https://example.org/t/provenance/packing") {
      for (const auto& file : node["crmdig:L22_created_derivative"]) {
        made.push_back(file["@id"].get<std::string>());
      }
    }
  }
  EXPECT_THAT(made,
              ::testing::ElementsAre("https://example.org/t/kept/mesh/old%20model%20%232%2C%2050%25.ply",
                                     "https://example.org/t/model/BM_1.draco.glb"));
  for (const char* name : {"kept/mesh/old model #2, 50%.ply", "\xC3\xA4/%41", "\xff?", "a%", "%2"}) {
    const std::string path = name;
    const std::string address = path_in_address(path);
    EXPECT_EQ(address.find_first_of(" #?\xC3\xA4\xff"), std::string::npos) << address;
    EXPECT_EQ(path_of_address(address), path);
  }
}

TEST(Provenance, AScanHappenedOnTheDeviceThatItNames) {
  ProvenanceInput input;
  input.base_url = "https://example.org/t/";
  input.program = "Dubsar";
  input.device = "rig:second.toml";
  // The device of a scan, or null where it has none.
  const auto device_of = [&](const std::string& scan) {
    const auto json = nlohmann::json::parse(provenance_jsonld(input));
    const auto find = [&](const nlohmann::json& id) {
      for (const auto& node : json["@graph"]) {
        if (node["@id"] == id) {
          return node;
        }
      }
      return nlohmann::json::object();
    };
    const nlohmann::json on = find(input.base_url + "provenance/" + scan)
                                  .value("crmdig:L12_happened_on_device", nlohmann::json::object());
    return on.contains("@id") ? find(on["@id"])["rdfs:label"] : nlohmann::json();
  };
  input.scans = {{0, "", "", "registered", true, {}, false, "first"},
                 {1, "", "", "registered", true, {}, false, "first"}};
  EXPECT_EQ(device_of("scan-0"), "rig:second.toml") << "all of one: that of the pages";
  input.scans.push_back({2, "", "", "registered", true, {}, false, "second"});
  input.scans.push_back({3, "", "", "registered", true, {}, false, ""});
  EXPECT_EQ(device_of("scan-1"), "first");
  EXPECT_EQ(device_of("scan-2"), "second");
  EXPECT_TRUE(device_of("scan-3").is_null()) << "nobody knows";
}

TEST(Provenance, EveryFileOfAStepHasItsSource) {
  ProvenanceInput input;
  input.base_url = "https://example.org/t/";
  input.identifier = "BM 1";
  input.cdli = "P123456";
  input.program = "Dubsar";
  input.when = "2026-01-02T03:04:05Z";
  input.scans = {
      {0, "2026-01-01T00:00:00Z", "scans/grids/000.grid", "registered", true, {{"RMS", 0.01, "mm"}}}};
  input.steps = {
      {"stitching", "Stitching", {"scans/grids/000.grid"}, {"model/t.ply"}, {{"gap", 0.5, "mm"}}, {}},
      {"analysis",
       "Measurement",
       {"model/t.ply"},
       {"wedges/wedges.json"},
       {},
       {},
       "Dubsar 0.0.9",
       "1 correction"}};
  const auto json = nlohmann::json::parse(provenance_jsonld(input));
  const auto& graph = json["@graph"];
  const auto find = [&](const std::string& id) {
    for (const auto& node : graph) {
      if (node["@id"] == input.base_url + id) {
        return node;
      }
    }
    return nlohmann::json();
  };
  EXPECT_EQ(find("provenance/scan-0")["crmdig:L20_has_created"]["@id"],
            "https://example.org/t/scans/grids/000.grid");
  EXPECT_EQ(find("provenance/stitching")["crmdig:L21_used_as_derivation_source"][0]["@id"],
            "https://example.org/t/scans/grids/000.grid");
  EXPECT_EQ(find("provenance/stitching")["crmdig:L13_used_parameters"][0]["rdfs:label"], "gap");
  const auto software = [&](const char* step) {
    const std::string id = find(step)["crmdig:L23_used_software_or_firmware"]["@id"];
    return find(id.substr(input.base_url.size()))["rdfs:label"];
  };
  EXPECT_EQ(software("provenance/stitching"), "Dubsar");
  EXPECT_EQ(software("provenance/analysis"), "Dubsar 0.0.9");
  EXPECT_EQ(find("provenance/analysis")["crm:P3_has_note"], "1 correction");
  EXPECT_EQ(find("tablet")["crm:P1_is_identified_by"][0]["rdfs:label"], "P123456");
}

}  // namespace
}  // namespace dubsar
