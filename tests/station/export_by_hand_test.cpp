// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: what people did goes along, their corrections, selections and signatures, and when they did
// it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "build_paths.h"
#include "core/number_text.h"
#include "formats/corrections_json.h"
#include "formats/mesh_io.h"
#include "formats/selections_json.h"
#include "tests/station/support/exported.h"
#include "tests/station/support/shell.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::quoted;
using test::run_command;
using test::shell;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::SizeIs;

class ExportByHand : public ExportOfACopy {
 protected:
  [[nodiscard]] Outcome pack(const std::vector<std::string>& more = {}) const {
    return pack_without("renderings,features,grid-ply", more);
  }
  [[nodiscard]] std::string info() const { return bytes_of(bag() / "bag-info.txt"); }
  [[nodiscard]] nlohmann::json provenance(const std::string& id) const {
    const auto json = nlohmann::json::parse(packed("provenance.jsonld"), nullptr, false);
    for (const auto& node : json["@graph"]) {
      if (node["@id"].get<std::string>().ends_with("/" + id)) {
        return node;
      }
    }
    return {};
  }
  void correct() const {
    WedgeCorrection gone;
    gone.at_mm = {{1, 2, 3}};
    ASSERT_TRUE(write_corrections(corrections(), {"model.ply", {gone}}));
  }
  void select() const {
    const Result<Mesh> mesh = read_mesh(session_ / "mesh/model.ply");
    ASSERT_TRUE(mesh);
    ASSERT_TRUE(write_selections(
        selections(), {"model.ply", surface_digest(*mesh), {{"line 3", MeshElement::kFace, {{7, 40}}}}}));
  }
  [[nodiscard]] fs::path corrections() const { return session_ / "analysis/wedges.corrections.json"; }
  [[nodiscard]] fs::path selections() const { return session_ / "analysis/selections.json"; }
};

/// As a disk that fails does.
void flip_a_bit(const fs::path& file, std::size_t at) {
  std::string bytes = bytes_of(file);
  bytes.at(at) = static_cast<char>(bytes.at(at) ^ 1);
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST_F(ExportByHand, CorrectionsAndSelectionsGoAlongToTheBit) {
  correct();
  select();
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.json()["lacking"], SizeIs(0));
  EXPECT_TRUE(packed("wedges/corrections.json") == bytes_of(corrections()));
  EXPECT_TRUE(packed("wedges/selections.json") == bytes_of(selections()));
  EXPECT_THAT(readme(), AllOf(HasSubstr("wedges/corrections.json what a person said of the wedges"),
                              HasSubstr("1 correction, 0 of which could be made: formats/corrections.txt"),
                              HasSubstr("(line 3): faces and vertices by their numbers in model/Corr"),
                              HasSubstr("formats/selections.txt"), Not(HasSubstr("kept/"))));
  EXPECT_THAT(packed("formats/selections.txt"), HasSubstr("surface_xxh128"));
  EXPECT_EQ(provenance("provenance/analysis")["crmdig:L21_used_as_derivation_source"].size(), 2U);
  EXPECT_THAT(provenance("provenance/analysis")["crmdig:L22_created_derivative"].dump(),
              Not(HasSubstr("selections.json")));
  EXPECT_THAT(provenance("provenance/packing")["crmdig:L22_created_derivative"].dump(),
              AllOf(HasSubstr("wedges/selections.json"), HasSubstr("wedges/corrections.json")));
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
  // They fit the model that they are said to fit.
  const fs::path away = at("away");
  fs::create_directories(away);
  for (const auto& model : fs::directory_iterator(bag() / "data/model")) {
    if (model.path().extension() == ".ply") {
      fs::copy(model.path(), away / "m.ply");
    }
  }
  fs::copy(bag() / "data/wedges/selections.json", away / "m.selections.json");
  const Outcome part = run_command({"mesh", "part", (away / "m.ply").string(), "--selection", "line 3", "-o",
                                    (away / "part.ply").string()});
  EXPECT_EQ(part.status, 0) << part.err;
}

TEST_F(ExportByHand, WithoutWedgesThePersonsWorkIsThereAllTheSame) {
  correct();
  const Outcome done = pack({"--without", "wedges"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_TRUE(packed("wedges/corrections.json") == bytes_of(corrections()));
  EXPECT_FALSE(fs::exists(bag() / "data/wedges/wedges.json"));
  EXPECT_THAT(packed("report/report.html"),
              AllOf(HasSubstr("<h2>Wedges</h2>\n<p>They are left out of this package.</p>"),
                    Not(HasSubstr("wedges/wedges.json"))));
}

TEST_F(ExportByHand, WhatIsDamagedIsKeptAndToldOf) {
  correct();
  select();
  flip_a_bit(corrections(), 40);
  flip_a_bit(selections(), 40);
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.json()["lacking"], SizeIs(2)) << done.json()["lacking"];
  for (const fs::path& file : {corrections(), selections()}) {
    const std::string name = file.lexically_relative(session_).generic_string();
    EXPECT_TRUE(packed("kept/" + name) == bytes_of(file));
    EXPECT_THAT(done.json()["lacking"].dump(), HasSubstr(name + " is damaged in the session"));
    EXPECT_THAT(readme(), HasSubstr("The file is here as it lies there: kept/" + name));
  }
  EXPECT_FALSE(fs::exists(bag() / "data/wedges/corrections.json"));
  EXPECT_THAT(provenance("provenance/packing").dump(), HasSubstr("kept/analysis/selections.json"));
}

TEST_F(ExportByHand, SelectionsOfTheMeshBeforeHaveThatMeshBesideThem) {
  select();
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "2", "--why", "dust"}).status, 0);
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_TRUE(packed("kept/mesh/model.ply") == bytes_of(session_ / "mesh/model.ply"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("by their numbers in kept/mesh/model.ply"),
                              HasSubstr("As the session keeps them these are not here"),
                              HasSubstr("export/report.html")));
}

TEST_F(ExportByHand, SelectionsKeepTheirMeshWhereASignedOneTakesItsPlace) {
  select();
  const std::string before = bytes_of(session_ / "mesh/model.ply");
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "2", "--why", "dust"}).status, 0);
  run_command({"register", session_.string()});
  run_command({"plan", session_.string()});
  const Outcome made =
      run_command({"session", "sign", session_.string(), "--name", "A", "--incomplete", "a trial"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("stays as mesh/model.of-selections-1.ply"));
  EXPECT_FALSE(bytes_of(session_ / "mesh/model.ply") == before);
  const std::string kept = "mesh/model.of-selections-1.ply";
  EXPECT_TRUE(bytes_of(session_ / kept) == before);
  const Outcome part = run_command({"mesh", "part", (session_ / kept).string(), "--selection", "line 3", "-o",
                                    at("part of it.ply").string()});
  EXPECT_EQ(part.status, 0) << part.err;
  const Outcome refused = run_command({"mesh", "part", (session_ / "mesh/model.ply").string(), "--selection",
                                       "line 3", "-o", at("no part.ply").string()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("they are of " + (session_ / kept).string() + ": name that mesh"));
  // What is signed is of one surface: so many wedges as the report says, in the session and in its package.
  const auto wedges = nlohmann::json::parse(bytes_of(session_ / "analysis/wedges.json"));
  const std::string count = wedges["wedges"].empty()
                                ? "No wedges were found; " + counted(wedges["rejected"].size(), "hollow")
                                : counted(wedges["wedges"].size(), "wedge") +
                                      (wedges["wedges"].size() == 1 ? " was measured" : " were measured");
  EXPECT_THAT(bytes_of(session_ / "export/report.html"), HasSubstr(count));
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, Not(HasSubstr("measured now"))) << "the session has those of its mesh";
  EXPECT_TRUE(packed("kept/" + kept) == before);
  const Outcome of_package = run_command(
      {"mesh", "part", (session_ / "mesh/model.ply").string(), "--selection", "line 3", "--selections",
       (bag() / "data/wedges/selections.json").string(), "-o", at("no part.ply").string()});
  EXPECT_THAT(of_package.err, HasSubstr("they are of " + (bag() / "data/kept" / kept).string()));
  EXPECT_THAT(readme(), HasSubstr("by their numbers in kept/" + kept));
  EXPECT_THAT(packed("report/report.html"), HasSubstr(count));
  EXPECT_THAT(packed("session/run.json"), HasSubstr(count));
  EXPECT_EQ(nlohmann::json::parse(packed("wedges/wedges.json"))["wedges"].size(), wedges["wedges"].size());
  EXPECT_EQ(run_command({"verify", session_.string()}).status, 0);
}

TEST_F(ExportByHand, ACorrectionThatTheSessionHasLostIsNotReplacedInThePackage) {
  correct();
  ASSERT_EQ(pack().status, 0);
  fs::remove(corrections());
  const Outcome refused = pack({"--update"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("the session no longer has analysis/wedges.corrections.json"));
  EXPECT_TRUE(fs::exists(bag() / "data/wedges/corrections.json"));
}

TEST_F(ExportByHand, WhatThePackageHasWholeAndTheSessionDamagedIsNotReplaced) {
  correct();
  select();
  ASSERT_EQ(pack().status, 0);
  const std::string said = bytes_of(corrections());
  const std::string selected = bytes_of(selections());
  for (const fs::path& file : {corrections(), selections()}) {
    const std::string whole = bytes_of(file);
    flip_a_bit(file, 40);
    for (const char* damage : {"a bit", "all of it"}) {
      const Outcome refused = pack({"--update"});
      EXPECT_EQ(refused.status, 2) << damage;
      EXPECT_THAT(refused.err, HasSubstr("the session no longer has " +
                                         file.lexically_relative(session_).generic_string()));
      EXPECT_TRUE(packed("wedges/corrections.json") == said);
      EXPECT_TRUE(packed("wedges/selections.json") == selected);
      std::ofstream(file, std::ios::binary) << "";
    }
    std::ofstream(file, std::ios::binary) << whole;
  }
  const Outcome whole_again = pack({"--update"});
  EXPECT_EQ(whole_again.status, 0) << whole_again.err;
}

TEST_F(ExportByHand, WhoSignedStandsWhereAnArchivistLooks) {
  ASSERT_EQ(pack().status, 0);
  EXPECT_THAT(info(), HasSubstr("\nDubsar-Signed: unsigned\n"));
  EXPECT_THAT(readme(), HasSubstr("Signature: unsigned."));
  EXPECT_EQ(provenance("provenance/signature-1"), nullptr);
  ASSERT_EQ(run_command({"session", "sign", session_.string(), "--name", "A. Reader", "--role", "conservator",
                         "--incomplete", "a trial"})
                .status,
            0);
  ASSERT_EQ(pack({"--update"}).status, 0);
  EXPECT_THAT(info(), HasSubstr("Dubsar-Signed: signed by A. Reader, conservator, 20"));
  EXPECT_THAT(info(), HasSubstr("(incomplete: a trial); it holds\n"));
  EXPECT_THAT(readme(), HasSubstr("Signature: signed by A. Reader, conservator"));
  EXPECT_THAT(readme(),
              HasSubstr("session/signed_1_checklist.json the checklist that sign-off 1 stands for"));
  const auto signing = provenance("provenance/signature-1");
  EXPECT_EQ(signing["@type"], "crm:E7_Activity") << signing;
  EXPECT_THAT(signing["crm:P16_used_specific_object"].dump(), HasSubstr("session/signed_1_red_map.json"));
  EXPECT_EQ(provenance("provenance/signature-1-by")["rdfs:label"], "A. Reader");
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "2", "--why", "dust"}).status, 0);
  ASSERT_EQ(pack({"--update"}).status, 0);
  EXPECT_THAT(info(), HasSubstr("(incomplete: a trial); VOID: "));
  EXPECT_THAT(
      readme(),
      AllOf(HasSubstr("; VOID: "),
            HasSubstr("Taken out by the operator, and in neither model nor verdict: scan 2 (dust).")));
  EXPECT_THAT(provenance("provenance/signature-1")["crm:P3_has_note"].get<std::string>(), HasSubstr("VOID"));
  EXPECT_THAT(packed("report/report.html"), HasSubstr("<td>taken out</td>"));
  EXPECT_THAT(packed("report/report.html"), HasSubstr("<td>dust</td></tr>"));
}

TEST_F(ExportByHand, WhenScansWereStoredIsSaidWhereTheirDeviceToldNoTime) {
  ASSERT_EQ(pack().status, 0);
  const auto scans = nlohmann::json::parse(packed("scans/scans.json"))["scans"];
  ASSERT_EQ(scans.size(), 3U);
  for (const auto& scan : scans) {
    ASSERT_EQ(scan["timestamp_ns"], 0);
    EXPECT_THAT(scan.value("stored", ""), MatchesRegex("20..-..-..T..:..:..Z"));
  }
  EXPECT_EQ(provenance("provenance/scan-1")["crm:P4_has_time-span"]["crm:P82b_end_of_the_end"]["@value"],
            scans[1]["stored"]);
  const std::string day = scans[0]["stored"].get<std::string>().substr(0, 10);
  EXPECT_THAT(readme(), HasSubstr("Scanned: " + day + ", "));
  EXPECT_THAT(packed("report/report.html"), AllOf(HasSubstr("<dt>Scanned</dt><dd>" + day),
                                                  HasSubstr("<span class=\"aside\">stored " + day)));
}

TEST_F(ExportByHand, WithoutARecordWhatLiesInTheSessionGoesAlong) {
  for (const char* table : {"session.sqlite", "session.backup.sqlite"}) {
    fs::remove(session_ / table);
  }
  std::ofstream(session_ / "letter.txt") << "of a curator";
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  for (const char* file : {"mesh/model.ply", "export/poses.json", "export/red_map.json", "export/report.html",
                           "export/checklist.html", "analysis/wedges.json"}) {
    ASSERT_TRUE(fs::exists(session_ / file)) << file;
    EXPECT_TRUE(packed(std::string("kept/") + file) == bytes_of(session_ / file)) << file;
  }
  EXPECT_THAT(readme(), AllOf(HasSubstr("kept/mesh/ model.ply: as they lie in the session"),
                              HasSubstr("no checksum was kept"), HasSubstr("letter.txt")));
  EXPECT_THAT(done.json()["lacking"].dump(),
              AllOf(HasSubstr("no record of these files"), HasSubstr("What else it once had on record")));
  EXPECT_THAT(provenance("provenance/packing").dump(), HasSubstr("kept/export/checklist.html"));
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
}

TEST_F(ExportByHand, AFileThatSomebodyPutIntoASessionIsNoLossOfItsRecord) {
  ASSERT_EQ(
      run_command({"session", "sign", session_.string(), "--name", "A", "--incomplete", "a trial"}).status,
      0);
  std::ofstream(session_ / "analysis/my-notes.txt") << "of a reader";
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(packed("kept/analysis/my-notes.txt"), "of a reader");
  ASSERT_THAT(done.json()["lacking"], SizeIs(1)) << done.json()["lacking"];
  EXPECT_THAT(done.json()["lacking"].dump(), HasSubstr("analysis/my-notes.txt"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("lie in the session without a record of it"),
                              Not(HasSubstr("once had on record"))));
}

TEST_F(ExportByHand, ASessionThatNeverHadPagesIsNotToldThatTheyAreOld) {
  const Outcome judged = pack();
  EXPECT_THAT(judged.err, Not(HasSubstr("pages")));
  ASSERT_EQ(run_command({"scan", "--device", "replay:" + at("scans").string(), "--session",
                         at("halted").string(), "--max-scans", "1"})
                .status,
            1);
  fs::remove(at("halted") / "export/report.html");
  fs::remove(at("halted") / "export/checklist.html");
  const Outcome done = run_command({"export", at("halted").string(), "--to", at("halted.bag").string(),
                                    "--without", "renderings,features,grid-ply,wedges"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr("the session keeps no pages"), Not(HasSubstr("as they lie now"))));
}

TEST_F(ExportByHand, TheTopOfADiskIsRefusedBeforeAnyWork) {
  for (const char* more : {"--json", "--force", "--update"}) {
    const Outcome refused = run_command({"export", session_.string(), "--to", "/proc", more});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.complaints(), SizeIs(1));
    EXPECT_THAT(refused.err, AllOf(HasSubstr("this is the top of a disk"), HasSubstr("/proc/package"),
                                   Not(HasSubstr("packing"))));
  }
}

TEST_F(ExportByHand, TheProvenanceOfASignedSessionHasTheShapeThatWeSay) {
  correct();
  ASSERT_EQ(
      run_command({"session", "sign", session_.string(), "--name", "A", "--incomplete", "a trial"}).status,
      0);
  ASSERT_EQ(
      run_command({"export", session_.string(), "--to", bag().string(), "--without", "renderings,features"})
          .status,
      0);
  EXPECT_THAT(packed("provenance.jsonld"), HasSubstr("crm:E7_Activity"));
  const fs::path schema = fs::path(DUBSAR_SOURCE_DIR) / "tests/station/schemas/provenance.json";
  EXPECT_EQ(shell("/usr/bin/python3 -c 'import json, jsonschema, sys; "
                  "jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))' " +
                  quoted(bag() / "data/provenance.jsonld") + " " + quoted(schema)),
            0);
}

}  // namespace
}  // namespace dubsar
