// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a package says of itself to whoever opens it without its makers: whose it is, whether it is of clay,
// where things lie in it; and what it must not say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "acquisition/session_store.h"
#include "tests/station/support/exported.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The session described so, and packed quickly.
Outcome pack_described(const fs::path& session, const fs::path& to, std::vector<std::string> words) {
  words.insert(words.begin(), {"session", "describe", session.string()});
  EXPECT_EQ(run_command(words).status, 0);
  return run_command({"export", session.string(), "--to", to.string(), "--without",
                      "renderings,features,wedges,grid-ply", "--json"});
}

TEST_F(Export, SaysWhoseItIsOrThatNobodySaidSo) {
  EXPECT_THAT(bytes_of(data("README.txt")), HasSubstr("Nobody has said whose these scans"));
  EXPECT_THAT(bytes_of(at("bag") / "bag-info.txt"), Not(HasSubstr("Rights:")));
  const fs::path session = at("owned");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const std::string rights = "© A Museum; CC BY 4.0 (https://creativecommons.org/licenses/by/4.0/)";
  ASSERT_EQ(pack_described(session, at("owned_bag"), {"--rights", rights}).status, 0);
  const fs::path packed = at("owned_bag") / "data";
  EXPECT_THAT(bytes_of(at("owned_bag") / "bag-info.txt"), HasSubstr("Rights: " + rights + "\n"));
  EXPECT_THAT(bytes_of(packed / "README.txt"), HasSubstr("  Rights: " + rights + "\n"));
  EXPECT_THAT(bytes_of(packed / "README.txt"), Not(HasSubstr("Nobody has said whose")));
  EXPECT_THAT(bytes_of(packed / "report/report.html"), HasSubstr("<dt>Rights</dt><dd>" + rights + "</dd>"));
  EXPECT_THAT(bytes_of(packed / "provenance.jsonld"),
              HasSubstr("\"https://creativecommons.org/licenses/by/4.0/\""));
}

TEST_F(Export, NamesNoFolderOfTheComputerThatItWasMadeOn) {
  const std::string folder = at("scans").parent_path().string();
  std::size_t looked_at = 0;
  for (const auto& entry : fs::recursive_directory_iterator(at("bag"))) {
    if (entry.is_regular_file()) {
      EXPECT_THAT(bytes_of(entry.path()).find(folder), std::string::npos) << entry.path();
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 50U);
  EXPECT_THAT(bytes_of(data("README.txt")), HasSubstr("  Scanned with: replay:scans\n"));
}

TEST_F(Export, SaysWhatTheWedgesAreWorthAndThatAnUnfinishedTabletMayLieAskew) {
  const std::string coarse =
      "Take care: too coarse for wedges of the usual size, many or all of them are missed";
  EXPECT_THAT(bytes_of(data("report/report.html")), HasSubstr(coarse));
  const std::string readme = std::regex_replace(bytes_of(data("README.txt")), std::regex("\\s+"), " ");
  EXPECT_THAT(readme, HasSubstr("Take care with the wedges: too coarse for wedges of the usual size"));
  EXPECT_THAT(readme, HasSubstr("The verdict is NOT CONCLUSIVE"));
  EXPECT_THAT(readme, HasSubstr("it may lie askew by some ten degrees or more in pictures and drawings"));
}

TEST_F(Export, ANumberThatIsGivenAfterTheSignatureIsToldBesideIt) {
  const fs::path session = at("renumbered");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(run_command({"session", "describe", session.string(), "--museum-number", "BM 1"}).status, 0);
  ASSERT_EQ(
      run_command({"session", "sign", session.string(), "--name", "A. Reader", "--incomplete", "a test"})
          .status,
      0);
  const std::string told = "what tablet it is was said or changed after that";
  ASSERT_EQ(pack_described(session, at("renumbered_as_it_was"), {"--museum-number", "BM 1"}).status, 0);
  EXPECT_THAT(bytes_of(at("renumbered_as_it_was") / "bag-info.txt"),
              AllOf(HasSubstr("signed by A. Reader"), Not(HasSubstr(told))));
  ASSERT_EQ(pack_described(session, at("renumbered_bag"), {"--museum-number", "VAT 99"}).status, 0);
  const std::string tags =
      std::regex_replace(bytes_of(at("renumbered_bag") / "bag-info.txt"), std::regex("\\s+"), " ");
  EXPECT_THAT(tags, AllOf(HasSubstr("signed by A. Reader"), HasSubstr(told)));
}

TEST_F(Export, ASimulatedTabletIsNotPassedOffAsClay) {
  EXPECT_THAT(bytes_of(data("README.txt")), HasSubstr("A cuneiform tablet, from files of scans, packed by"))
      << "by whatever scanner";
  const fs::path session = at("made_up");
  ASSERT_NE(run_command({"scan", "--device", "sim:?seed=2&size=14x11x8&spacing=0.5", "--session",
                         session.string(), "--max-scans", "1"})
                .status,
            2);
  ASSERT_EQ(pack_described(session, at("made_up_bag"), {"--cdli", "P000001"}).status, 0);
  const fs::path packed = at("made_up_bag") / "data";
  EXPECT_THAT(bytes_of(at("made_up_bag") / "bag-info.txt"), HasSubstr("External-Description: SIMULATED. "));
  for (const char* page :
       {"README.txt", "report/report.html", "report/checklist.html", "provenance.jsonld"}) {
    EXPECT_THAT(bytes_of(packed / page), HasSubstr("there is no such tablet")) << page;
  }
  EXPECT_THAT(bytes_of(packed / "README.txt"), Not(HasSubstr("measured by laser")));
}

TEST_F(ExportOfACopy, OfSeveralDevicesTheLastIsNotGivenTheScansOfTheOthers) {
  {
    RangeGrid other = test::bumpy_scan(3);
    other.device = "second scanner";
    SessionStore store = SessionStore::open(session_).value();
    ASSERT_TRUE(store.add_grid(other));
  }
  ASSERT_EQ(pack_without("renderings,features,grid-ply,wedges", {}).status, 0);
  EXPECT_THAT(bytes_of(bag() / "bag-info.txt"), HasSubstr("measured with several devices: "));
  EXPECT_THAT(readme(),
              AllOf(HasSubstr("A cuneiform tablet, measured with several devices"),
                    HasSubstr("Scanned with: replay:scans (the scan that was stored last; the scans name: "
                              "second scanner; and some name none)")));
  const auto graph = nlohmann::json::parse(packed("provenance.jsonld"))["@graph"];
  const auto happened_on = [&](const std::string& scan) {
    for (const auto& node : graph) {
      if (node["@id"].get<std::string>().ends_with("/provenance/" + scan)) {
        return node.contains("crmdig:L12_happened_on_device");
      }
    }
    ADD_FAILURE() << scan;
    return false;
  };
  EXPECT_TRUE(happened_on("scan-3"));
  EXPECT_FALSE(happened_on("scan-0")) << "it names none, and the last was another";
}

TEST_F(Export, MeshesAndScansSayWhatTheyAreWhereTheyTravelAlone) {
  const std::string unnamed = bytes_of(data("model/session.ply"));
  EXPECT_THAT(unnamed.substr(0, unnamed.find("end_header")), HasSubstr("comment Session: session\n"));
  for (const char* picture : {"pictures/clay/03_front.png", "pictures/cdli/session_o.jpg",
                              "pictures/fatcross/session_ebl_300dpi.tif",
                              "pictures/fatcross/session_cdli_600dpi.jpg", "pictures/session_rollout.png"}) {
    EXPECT_THAT(bytes_of(data(picture)), AllOf(HasSubstr("Session: session"), HasSubstr("session, ")))
        << picture;
  }
  EXPECT_THAT(bytes_of(data("features/msii.mat")), HasSubstr("\n# Session: session\n0 "));
  const fs::path session = at("alone");
  ASSERT_NE(run_command({"scan", "--device", "sim:?seed=2&size=14x11x8&spacing=0.5", "--session",
                         session.string(), "--max-scans", "2"})
                .status,
            2);
  ASSERT_EQ(
      run_command({"session", "describe", session.string(), "--museum-number", "BM 12345", "--cdli",
                   "P000001", "--collection", "A Museum", "--rights", "© A Museum; CC0", "--notes", "mine"})
          .status,
      0);
  ASSERT_EQ(run_command({"export", session.string(), "--to", at("alone_bag").string(), "--without",
                         "renderings,features"})
                .status,
            0);
  EXPECT_THAT(bytes_of(at("alone_bag") / "data/wedges/wedges.json"),
              AllOf(HasSubstr("there is no such tablet"), HasSubstr("\"Museum number\": \"BM 12345\""),
                    HasSubstr("\"Rights\": \"© A Museum; CC0\""), Not(HasSubstr("mine"))));
  const std::string stl = bytes_of(at("alone_bag") / "data/model/P000001.stl");
  EXPECT_THAT(stl, ::testing::StartsWith("Dubsar, mm; SIMULATED; P000001, BM 12345; (c) A Museum; CC0"));
  const std::string glb = bytes_of(at("alone_bag") / "data/model/P000001.glb");
  EXPECT_THAT(glb, HasSubstr("\"copyright\":"));
  EXPECT_THAT(glb, HasSubstr("there is no such tablet"));
  const fs::path converted = at("converted.ply");
  ASSERT_EQ(run_command({"mesh", "convert", (at("alone_bag") / "data/model/P000001.glb").string(),
                         converted.string()})
                .status,
            0);
  const fs::path stitched = at("alone.ply");
  ASSERT_EQ(run_command({"stitch", session.string(), "-o", stitched.string()}).status, 0);
  for (const fs::path& file : {at("alone_bag") / "data/model/P000001.ply",
                               at("alone_bag") / "data/scans/ply/000.ply", stitched, converted}) {
    const std::string ply = bytes_of(file);
    const std::string head = ply.substr(0, ply.find("end_header"));
    EXPECT_THAT(head, HasSubstr("comment SIMULATED: A program made up this tablet")) << file;
    EXPECT_THAT(head, AllOf(HasSubstr("comment Museum number: BM 12345\n"),
                            HasSubstr("comment CDLI number: P000001\n")))
        << file;
    EXPECT_THAT(head, HasSubstr("comment Rights: © A Museum; CC0\n")) << file;
    EXPECT_THAT(head, Not(HasSubstr("mine"))) << file;
  }
}

TEST_F(Export, PagesAndTheRedMapSayWhatTheyAreWhereTheyTravelAlone) {
  const fs::path session = at("paged");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(
      pack_described(session, at("paged_bag"), {"--museum-number", "BM 7", "--rights", "© A; CC0"}).status,
      0);
  const std::string red_map = bytes_of(at("paged_bag") / "data/report/red_map.png");
  EXPECT_THAT(red_map, HasSubstr("Copyright")) << "described after it was drawn";
  EXPECT_THAT(red_map, AllOf(HasSubstr("© A; CC0"), HasSubstr("Museum number: BM 7"),
                             HasSubstr("BM 7, red map"), Not(HasSubstr("session, red map"))));
  const std::string pdf = bytes_of(at("paged_bag") / "data/report/report.pdf");
  EXPECT_THAT(pdf, HasSubstr("<dc:rights><rdf:Alt><rdf:li xml:lang=\"x-default\">© A; CC0<"));
  EXPECT_THAT(pdf, HasSubstr("Museum number: BM 7"));
}

/// They are made anew from the scans, the same to the byte, wherever the session lies and whatever was typed
/// since.
TEST_F(Export, TheSessionsOwnFilesSayNothingButWhatItsScansTell) {
  const std::string mesh = bytes_of(at("session") / "mesh/model.ply");
  EXPECT_EQ(mesh.substr(0, mesh.find("end_header")).find("Session"), std::string::npos);
  for (const char* picture : {"six_views.png", "red_map.png"}) {
    EXPECT_NE(bytes_of(at("session") / "export" / picture).find("session, "), std::string::npos) << picture;
  }
}

TEST_F(Export, FileNamesAreGoodOnOtherSystems) {
  const fs::path session = at("named");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  int count = 0;
  std::set<std::string> tablets;
  for (const auto& [number, stem] :
       {std::pair{"nul", "tablet_nul"}, std::pair{"COM1.a", "tablet_COM1.a"}, std::pair{"Console", "Console"},
        std::pair{R"(VAT 12/34 + "x" ü?)", "VAT_12_34_x"}, std::pair{"𒀭", "named"},
        std::pair{"متحف ١٢٣", "named"}, std::pair{"متحف ١٢٤", "named"}}) {
    const fs::path bag = at("named_bag_" + std::to_string(count++));
    ASSERT_EQ(pack_described(session, bag, {"--museum-number", number}).status, 0);
    EXPECT_TRUE(fs::exists(bag / "data/model" / (std::string(stem) + ".ply"))) << number;
    const auto graph = nlohmann::json::parse(bytes_of(bag / "data/provenance.jsonld"))["@graph"];
    EXPECT_TRUE(tablets.insert(graph[1]["@id"]).second) << number << " has the address of another tablet";
    EXPECT_EQ(graph[1]["@type"], "crm:E22_Human-Made_Object");
  }
}

TEST_F(Export, NotesOfSeveralLinesStayUnderTheirHeading) {
  const fs::path session = at("noted");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(pack_described(session, at("noted_bag"), {"--notes", "one\n\nTHE FILES\ntwo"}).status, 0);
  EXPECT_THAT(bytes_of(at("noted_bag") / "data/README.txt"), HasSubstr("  Notes: one THE FILES two\n"));
}

TEST_F(Export, SaysOfADamagedSessionThatItsRecordIsNotWhole) {
  EXPECT_THAT(bytes_of(data("README.txt")), Not(HasSubstr("own record was not whole")));
  const fs::path session = at("emptied");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  std::ofstream(session / "session.sqlite", std::ios::trunc);
  fs::remove(session / "session.backup.sqlite");
  const Outcome packed = run_command({"export", session.string(), "--to", at("emptied_bag").string()});
  ASSERT_EQ(packed.status, 0) << packed.err;
  EXPECT_THAT(packed.err, HasSubstr("the database is missing or empty"));
  EXPECT_THAT(bytes_of(at("emptied_bag") / "data/README.txt"),
              HasSubstr("own record was not whole: the database is missing"));
}

TEST_F(Export, TheLabelOfTheBagNamesWhatIsInItOnly) {
  EXPECT_THAT(bytes_of(at("bag") / "bag-info.txt"),
              HasSubstr(": raw range grids, poses, model, pictures, report. "));
  EXPECT_THAT(bytes_of(data("README.txt")), HasSubstr("No wedge was found on the model"));
  ASSERT_EQ(export_to("unpictured", {"--without", "renderings"}).status, 0);
  const std::string readme = bytes_of(at("unpictured") / "data/README.txt");
  EXPECT_THAT(readme, Not(HasSubstr("iiif")));
  EXPECT_THAT(readme, HasSubstr("The addresses in wedges/annotations.json and provenance.jsonld"));
  EXPECT_THAT(readme, Not(HasSubstr("\n\n\n")));
  EXPECT_THAT(bytes_of(at("unpictured") / "bag-info.txt"),
              HasSubstr(": raw range grids, poses, model, report. "));
}

}  // namespace
}  // namespace dubsar
