// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export of an inscribed tablet: what it says of the wedges, held against the definitions of others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <set>

#include "build_paths.h"
#include "formats/corrections_json.h"
#include "formats/wedges_json.h"
#include "tests/station/support/command.h"
#include "tests/station/support/shell.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::quoted;
using test::run_command;
using test::shell;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What the simulator writes into its scans goes all the way.
constexpr const char* kMadeUp =
    "A program made up this tablet and its scans: there is no such tablet, and nothing was measured.";

class ExportOfWedges : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    ASSERT_EQ(run_command({"simulate", "tablet", "--seed", "3", "--size", "16x14x9", "--spacing", "0.12",
                           "-o", at("t")})
                  .status,
              0);
    ASSERT_EQ(run_command({"simulate", "scans", "--tablet", at("t/tablet.ply"), "--views", "2", "--spacing",
                           "0.15", "-o", at("scans")})
                  .status,
              0);
    ASSERT_EQ(run_command({"scan", "--device", "replay:" + at("scans").string(), "--session", at("session")})
                  .status,
              1);
    exported_ = run_command(
        {"export", at("session"), "--to", at("bag"), "--without", "renderings,features,grid-ply", "--json"});
    ASSERT_EQ(exported_.status, 0) << exported_.err;
  }
  static void TearDownTestSuite() { delete folder_; }
  [[nodiscard]] static fs::path at(const std::string& name) { return folder_->path() / name; }
  [[nodiscard]] static fs::path data(const char* name) { return at("bag") / "data" / name; }
  [[nodiscard]] static nlohmann::json json_of(const char* name) {
    return nlohmann::json::parse(bytes_of(data(name)), nullptr, false);
  }

  static test::TemporaryFolder* folder_;
  static Outcome exported_;
};
/// In integral invariants hollows are dark: inside the triangles they must be darker than the clay is.
void expect_hollows(const fs::path& msii, const nlohmann::json& page) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&png, msii.c_str()), 0) << png.message;
  png.format = PNG_FORMAT_GRAY;
  std::vector<std::uint8_t> pixels(std::size_t{png.width} * png.height);
  ASSERT_NE(png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr), 0) << png.message;
  double all = 0;
  double clay = 0;
  for (const std::uint8_t pixel : pixels) {
    all += pixel > 0 ? 1 : 0;
    clay += pixel;
  }
  int dark = 0;
  int looked_at = 0;
  for (const nlohmann::json& item : page["items"]) {
    const std::string svg = item["target"]["selector"][1]["value"];
    double x[3];
    double y[3];
    ASSERT_EQ(std::sscanf(svg.c_str() + svg.find("d=\"") + 3, "M%lf %lfL%lf %lfL%lf %lfZ", &x[0], &y[0],
                          &x[1], &y[1], &x[2], &y[2]),
              6)
        << svg;
    const auto column = static_cast<std::size_t>((x[0] + x[1] + x[2]) / 3);
    const auto row = static_cast<std::size_t>((y[0] + y[1] + y[2]) / 3);
    ASSERT_LT(column, png.width);
    ASSERT_LT(row, png.height);
    ++looked_at;
    dark += pixels[row * png.width + column] < 0.8 * clay / all ? 1 : 0;
  }
  EXPECT_GT(looked_at, 10);
  EXPECT_GT(dark, 0.9 * looked_at);
}

test::TemporaryFolder* ExportOfWedges::folder_ = nullptr;
Outcome ExportOfWedges::exported_;

TEST_F(ExportOfWedges, EveryFormHasAsMany) {
  const auto wedges = json_of("wedges/wedges.json")["wedges"];
  ASSERT_GT(wedges.size(), 10U);
  EXPECT_EQ(exported_.json()["wedges"], wedges.size());
  EXPECT_EQ(json_of("wedges/annotations.json")["items"].size(), wedges.size());
  const std::string csv = bytes_of(data("wedges/wedges.csv"));
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), wedges.size() + 1);
}

TEST_F(ExportOfWedges, TheyTellWhatTheyAreOfWhereTheyTravelAlone) {
  const nlohmann::json of{{"SIMULATED", kMadeUp}, {"Session", "session"}};
  EXPECT_EQ(json_of("wedges/wedges.json").value("tablet", nlohmann::json()), of);
  EXPECT_THAT(bytes_of(data("wedges/wedges.csv")), EndsWith(",session,,,yes\r\n"));
  ASSERT_EQ(run_command({"analyze", data("model/session.ply"), "-o", at("alone.json")}).status, 0);
  const auto alone = nlohmann::json::parse(bytes_of(at("alone.json")), nullptr, false);
  EXPECT_EQ(alone.value("tablet", nlohmann::json()), of) << "as the mesh says";
}

TEST_F(ExportOfWedges, DrawingsAreWhatW3CCallsSvg11) {
  if (!fs::is_directory("/usr/share/xml/w3c-sgml-lib/schema/dtd/REC-SVG11-20110816")) {
    FAIL() << "install libxml2-utils and w3c-sgml-lib (packages.txt) to hold the drawings against them";
  }
  const fs::path cut = at("cut \x01\xff&<.svg");  // its title is the file's name
  ASSERT_EQ(
      run_command({"mesh", "section", data("model/session.ply"), "--from=-4,0,5", "--to=4,0,5", "-o", cut})
          .status,
      0);
  EXPECT_THAT(bytes_of(cut), HasSubstr("Session: session")) << "it says what the mesh says";
  std::vector<fs::path> drawings{cut};
  for (const auto& file : fs::directory_iterator(data("wedges/drawings"))) {
    drawings.push_back(file.path());
  }
  ASSERT_GE(drawings.size(), 2U);
  // What stands in metadata is no part of SVG: W3C's own definition is asked about the rest, and once more
  // with the place in it that it leaves for that.
  const std::string check = "xmllint --nonet --noout --dtdvalidfpi '-//W3C//DTD SVG 1.1//EN' ";
  const std::string whole = "xmllint --nonet --noout --dtdvalid " +
                            quoted(fs::path(DUBSAR_SOURCE_DIR) / "tests/station/support/svg11_with_rdf.dtd") +
                            " ";
  for (const fs::path& drawing : drawings) {
    EXPECT_EQ(shell(whole + quoted(drawing)), 0) << drawing;
    const std::string svg = bytes_of(drawing);
    std::ofstream(at("bare.svg")) << svg.substr(0, svg.find("<rdf:RDF"))
                                  << (svg.contains("<rdf:RDF") ? svg.substr(svg.find("</rdf:RDF>") + 10)
                                                               : "");
    EXPECT_EQ(shell(check + quoted(at("bare.svg"))), 0) << drawing;
  }
  // What no version of SVG knows is found by this.
  std::string other = bytes_of(drawings.back());
  other.replace(other.find("<title>"), 7, "<titel/><title>");
  std::ofstream(at("other.svg")) << other;
  EXPECT_NE(shell(whole + quoted(at("other.svg"))), 0);
}

TEST_F(ExportOfWedges, DrawingsSayWhatTheyAreWhereTheyTravelAlone) {
  if (std::system("/usr/bin/python3 -c 'import rdflib' 2>/dev/null") != 0) {
    FAIL() << "install python3-rdflib (packages.txt) to read what the drawings say of themselves";
  }
  const fs::path session = at("owned");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(run_command({"session", "describe", session, "--museum-number", "BM <1>", "--rights",
                         "© A Museum & others; CC0"})
                .status,
            0);
  ASSERT_EQ(
      run_command({"export", session, "--to", at("owned_bag"), "--without", "renderings,features,grid-ply"})
          .status,
      0);
  const fs::path drawing = at("owned_bag") / "data/wedges/drawings/obverse.svg";
  const std::string svg = bytes_of(drawing);
  std::ofstream(at("said.rdf")) << svg.substr(svg.find("<rdf:RDF"),
                                              svg.find("</rdf:RDF>") + 10 - svg.find("<rdf:RDF"));
  const auto says = [&](const char* name, const std::string& what) {
    return shell(
        "/usr/bin/python3 -c 'import rdflib, sys; g = rdflib.Graph(); "
        "g.parse(sys.argv[1], format=\"xml\"); "
        "alts = list(g.objects(None, rdflib.URIRef(\"http://purl.org/dc/elements/1.1/\" + sys.argv[2]))); "
        "values = [str(o) for a in alts for o in g.objects(a, rdflib.RDF._1)]; "
        "sys.exit(0 if len(values) == 1 and sys.argv[3] in values[0] else 1)' " +
        quoted(at("said.rdf")) + " " + name + " " + test::quoted(what));
  };
  EXPECT_EQ(says("title", "BM <1>, obverse"), 0);
  EXPECT_EQ(says("rights", "© A Museum & others; CC0"), 0);
  EXPECT_EQ(says("description", "Museum number: BM <1>"), 0);
  // What analysis draws of a mesh that says whose it is says the same.
  ASSERT_EQ(run_command({"analyze", at("owned_bag") / "data/model/BM_1.ply", "-o", at("again.json"), "--svg",
                         at("again_svg")})
                .status,
            0);
  EXPECT_THAT(bytes_of(at("again_svg") / "obverse.svg"), HasSubstr("© A Museum &amp; others; CC0"));
}

TEST_F(ExportOfWedges, AnnotationsHaveTheShapeOfTheStandard) {
  const fs::path schema = fs::path(DUBSAR_SOURCE_DIR) / "tests/station/schemas/annotation_page.json";
  const std::string check =
      "/usr/bin/python3 -c 'import json, jsonschema, sys; "
      "jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))' ";
  EXPECT_EQ(shell(check + quoted(data("wedges/annotations.json")) + " " + quoted(schema)), 0);
  const nlohmann::json page = json_of("wedges/annotations.json");
  EXPECT_THAT(page["id"].get<std::string>(), EndsWith("/wedges/annotations.json")) << "where it is served";
  EXPECT_THAT(page["items"][0]["target"]["selector"]["value"].get<std::string>(), HasSubstr("POLYGON Z"));
}

TEST_F(ExportOfWedges, OnThePicturesWedgesAreWhereTheHollowsAre) {
  const fs::path session = at("drawn_session");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(run_command({"session", "describe", session, "--rights",
                         "In copyright, https://rightsstatements.org/page/InC/1.0/?language=en"})
                .status,
            0);
  const Outcome drawn = run_command({"export", session, "--to", at("drawn"), "--without", "features,grid-ply",
                                     "--base-url", "https://example.org/t"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const auto json = [](const std::string& name) {
    return nlohmann::json::parse(bytes_of(at("drawn") / "data" / name), nullptr, false);
  };
  const std::size_t wedges = json("wedges/wedges.json")["wedges"].size();
  const fs::path schemas = fs::path(DUBSAR_SOURCE_DIR) / "tests/station/schemas";
  const std::string valid =
      "/usr/bin/python3 -c 'import json, jsonschema, sys; "
      "jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))' ";
  std::size_t pages = 0;
  const nlohmann::json manifest = json("iiif/manifest.json");
  EXPECT_EQ(manifest["rights"], "http://rightsstatements.org/vocab/InC/1.0/");
  EXPECT_EQ(shell(valid + quoted(at("drawn") / "data/iiif/manifest.json") + " " +
                  quoted(schemas / "iiif_manifest.json")),
            0);
  for (const nlohmann::json& canvas : manifest["items"]) {
    const std::string picture = canvas["items"][0]["items"][0]["body"]["id"].get<std::string>().substr(22);
    if (!canvas.contains("annotations")) {
      EXPECT_EQ(picture.find("front"), std::string::npos) << picture;
      continue;
    }
    SCOPED_TRACE(picture);
    ++pages;
    const std::string address = canvas["annotations"][0]["id"];
    ASSERT_THAT(address, StartsWith("https://example.org/t/iiif/annotations/"));
    const std::string file = address.substr(22);
    EXPECT_EQ(shell(valid + quoted(at("drawn") / "data" / file) + " " +
                    quoted(schemas / "canvas_annotations.json")),
              0);
    const nlohmann::json page = json(file);
    EXPECT_EQ(page["id"], address);
    EXPECT_EQ(page["rights"], manifest["rights"]);
    std::set<std::string> ids;
    for (const nlohmann::json& item : page["items"]) {
      EXPECT_EQ(item["target"]["source"]["id"], canvas["id"]);
      EXPECT_TRUE(ids.insert(item["id"]).second) << item["id"] << " is there twice";
    }
    if (picture.starts_with("pictures/fatcross/")) {
      EXPECT_GE(page["items"].size(), wedges * 9 / 10) << "nearly all of them are on some side";
    } else if (picture == "pictures/msii/03_front.png") {
      expect_hollows(at("drawn") / "data" / picture, page);
    }
  }
  EXPECT_GT(pages, 5U);
  EXPECT_EQ(shell("cd " + quoted(at("drawn") / "data/iiif/annotations") +
                  " && [ $(ls | wc -l) = " + std::to_string(pages) + " ]"),
            0);
}

TEST_F(ExportOfWedges, CorrectionsOfTheSessionAreMadeAndCounted) {
  const fs::path session = at("corrected");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const std::vector<Wedge> found = read_wedges(data("wedges/wedges.json"))->wedges;
  WedgeCorrection gone;
  gone.at_mm = {found[3].depth_point_mm};
  ASSERT_TRUE(write_corrections(session / "analysis/wedges.corrections.json", {"session.ply", {gone}}));
  const Outcome exported = run_command({"export", session, "--to", at("corrected_bag"), "--without",
                                        "renderings,features,grid-ply", "--json"});
  ASSERT_EQ(exported.status, 0) << exported.err;
  const Result<WedgeFile> left = read_wedges(at("corrected_bag") / "data/wedges/wedges.json");
  ASSERT_TRUE(left);
  EXPECT_EQ(left->corrections, 1U);
  EXPECT_THAT(left->program, StartsWith("Dubsar "));
  EXPECT_GT(left->method, 0);
  ASSERT_EQ(left->wedges.size(), found.size() - 1);
  EXPECT_EQ(left->wedges[3].id, found[4].id) << "the others keep their numbers";
  EXPECT_EQ(left->wedges[3].depth_point_mm, found[4].depth_point_mm);
  EXPECT_EQ(run_command({"verify", at("corrected_bag")}).status, 0);
  EXPECT_THAT(bytes_of(at("corrected_bag") / "data/provenance.jsonld"),
              HasSubstr("A person has corrected what was found: 1 correction was made."));
}

}  // namespace
}  // namespace dubsar
