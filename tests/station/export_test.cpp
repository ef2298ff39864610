// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: the package is whole, in forms that others read, and never half there.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <regex>
#include <thread>

#include "acquisition/session_store.h"
#include "formats/mesh_io.h"
#include "formats/poses_json.h"
#include "tests/station/support/exported.h"
#include "tests/station/support/shell.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::files_below;
using test::Outcome;
using test::quoted;
using test::run_command;
using test::shell;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

TEST_F(Export, PacksEverythingWhateverTheVerdictSays) {
  ASSERT_EQ(whole_.status, 0) << whole_.err;
  const nlohmann::json json = whole_.json();
  EXPECT_EQ(json["conclusive"], false);
  EXPECT_EQ(json["scans"], 3);
  EXPECT_EQ(json["mesh"], true);
  const auto files = files_below(at("bag"));
  EXPECT_EQ(json["files"].get<std::size_t>(), files.size() - 4);
  for (const char* file : {"bagit.txt",
                           "bag-info.txt",
                           "manifest-sha512.txt",
                           "tagmanifest-sha512.txt",
                           "data/README.txt",
                           "data/scans/grids/002.grid",
                           "data/scans/ply/002.ply",
                           "data/scans/poses.json",
                           "data/scans/scans.json",
                           "data/verdict/red_map.json",
                           "data/verdict/checklist.json",
                           "data/session/events.json",
                           "data/formats/grid.txt",
                           "data/model/session.ply",
                           "data/model/session.glb",
                           "data/model/session.stl",
                           "data/pictures/clay/01_top.png",
                           "data/pictures/msii/03_front.png",
                           "data/pictures/ao/05_bottom.png",
                           "data/pictures/radiance/06_back.png",
                           "data/pictures/cdli/session_te.jpg",
                           "data/pictures/fatcross/session_cdli_1000dpi.tif",
                           "data/pictures/fatcross/session_ebl_300dpi.jpg",
                           "data/pictures/session_rollout.png",
                           "data/features/openness.mat",
                           "data/features/msii.mat",
                           "data/wedges/wedges.json",
                           "data/wedges/wedges.csv",
                           "data/wedges/annotations.json",
                           "data/report/report.html",
                           "data/report/report.pdf",
                           "data/iiif/manifest.json",
                           "data/provenance.jsonld"}) {
    EXPECT_THAT(files, Contains(file));
  }
  const std::string readme = bytes_of(data("README.txt"));
  EXPECT_THAT(readme, HasSubstr("NOT CONCLUSIVE"));
  for (const std::string& file : files) {
    const std::string name = file.substr(file.find('/') + 1);
    if (file.starts_with("data/") && name != "README.txt") {
      EXPECT_TRUE(readme.find("  " + name + "\n") != std::string::npos ||
                  readme.find("  " + name.substr(0, name.rfind('/') + 1) + "\n") != std::string::npos)
          << file << " is not explained";
    }
  }
}

TEST_F(Export, EveryFormOfItsOwnIsDescribedAndEveryLinkLeadsSomewhere) {
  const std::string session = bytes_of(data("formats/session.txt"));
  EXPECT_THAT(session, HasSubstr("scans/scans.json"));
  for (const std::string& file : files_below(data("session"))) {
    EXPECT_THAT(session, HasSubstr("`" + file + "`"));
  }
  const nlohmann::json scans = nlohmann::json::parse(bytes_of(data("scans/scans.json")))["scans"];
  for (const auto& [key, value] : scans.at(0).items()) {
    EXPECT_THAT(session, HasSubstr("`" + key + "`"));
  }
  for (const std::string& file : files_below(data("formats"))) {
    const std::string text = bytes_of(data("formats/" + file));
    const std::regex link("\\]\\(([^)#]*)");
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string to = (*at)[1];
      if (!to.empty() && !to.starts_with("http")) {
        EXPECT_TRUE(fs::exists(data("formats/" + to))) << file << " links to " << to;
      }
    }
  }
}

TEST_F(Export, NoDocumentOfTheSessionIsWrittenOverAnother) {
  const fs::path session = at("documents");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const std::map<std::string, std::string> texts = {
      {"a b", R"({"n":1})"}, {"a/b", R"({"n":2})"}, {"A_b", R"({"n":3})"}, {"events", R"({"n":4})"}};
  {
    Result<SessionStore> store = SessionStore::open_or_create(session);
    for (const auto& [name, text] : texts) {
      ASSERT_TRUE(store->save_document(name, text));
    }
  }
  const Outcome packed = run_command({"export", session.string(), "--to", at("documents_bag").string(),
                                      "--without", "renderings,features,wedges,grid-ply"});
  ASSERT_EQ(packed.status, 0) << packed.err;
  const fs::path root = at("documents_bag") / "data";
  std::vector<std::string> kept;
  for (const std::string& file : files_below(root / "session")) {
    kept.push_back(bytes_of(root / "session" / file));
  }
  const std::string readme = bytes_of(root / "README.txt");
  for (const auto& [name, text] : texts) {
    EXPECT_THAT(kept, Contains(text));
    EXPECT_THAT(readme, HasSubstr("document \"" + name + "\"")) << "which file it is";
  }
  EXPECT_TRUE(nlohmann::json::parse(bytes_of(root / "session/events.json")).is_array());
}

TEST_F(Export, EveryByteIsCoveredByAChecksum) {
  const std::string bag = quoted(at("bag"));
  EXPECT_EQ(
      shell("cd " + bag + " && sha512sum --quiet --strict -c manifest-sha512.txt tagmanifest-sha512.txt"), 0);
  const std::string manifest = bytes_of(at("bag") / "manifest-sha512.txt");
  std::uint64_t bytes = 0;
  std::size_t count = 0;
  for (const std::string& file : files_below(at("bag") / "data")) {
    EXPECT_THAT(manifest, HasSubstr("  data/" + file + "\n"));
    bytes += fs::file_size(at("bag") / "data" / file);
    ++count;
  }
  EXPECT_THAT(bytes_of(at("bag") / "bag-info.txt"),
              HasSubstr("Payload-Oxum: " + std::to_string(bytes) + "." + std::to_string(count) + "\n"));
}

TEST_F(Export, ScansModelAndPosesAreThoseOfTheSession) {
  for (const char* id : {"000", "001", "002"}) {
    EXPECT_TRUE(bytes_of(data(std::string("scans/grids/") + id + ".grid")) ==
                bytes_of(at("session") / "grids" / (std::string(id) + ".grid")));
  }
  // The packed ones say what they are of.
  const auto from = [](const char* word, const std::string& bytes) { return bytes.substr(bytes.find(word)); };
  EXPECT_TRUE(from("obj_info unit mm", bytes_of(data("model/session.ply"))) ==
              from("obj_info unit mm", bytes_of(at("session") / "mesh" / "model.ply")));
  EXPECT_TRUE(from("IDAT", bytes_of(data("report/red_map.png"))) ==
              from("IDAT", bytes_of(at("session") / "export" / "red_map.png")));
  EXPECT_EQ(bytes_of(data("verdict/red_map.json")), bytes_of(at("session") / "export" / "red_map.json"));
  EXPECT_EQ(read_poses(data("scans/poses.json"))->size(), 3U);
  // Another reader than the grid's own gives the same samples.
  const Outcome again = run_command({"register", data("scans/ply").string(), "--json"});
  EXPECT_EQ(again.json()["scans"].size(), 3U) << again.err;
  const auto master = read_mesh(data("model/session.ply"));
  const auto access = read_mesh(data("model/session.glb"));
  ASSERT_TRUE(master);
  ASSERT_TRUE(access);
  ASSERT_EQ(access->faces.size(), master->faces.size());
  EXPECT_EQ(access->positions.front(), master->positions.front()) << "metres and back";
}

TEST_F(Export, TheSessionIsOnlyRead) {
  std::map<std::string, std::string> before;
  for (const std::string& file : files_below(at("session"))) {
    before[file] = bytes_of(at("session") / file);
  }
  const Outcome again = export_to("again", {"--without", "renderings"});
  ASSERT_EQ(again.status, 0) << again.err;
  for (const std::string& file : files_below(at("session"))) {
    EXPECT_TRUE(before[file] == bytes_of(at("session") / file)) << file;
  }
  EXPECT_FALSE(fs::exists(at("again") / "data" / "pictures"));
  EXPECT_FALSE(fs::exists(at("again") / "data" / "iiif"));
  EXPECT_THAT(bytes_of(at("again") / "data" / "README.txt"), HasSubstr("asked to leave them out"));
  EXPECT_TRUE(bytes_of(at("again") / "data" / "features" / "msii.mat") ==
              bytes_of(data("features/msii.mat")));
}

TEST_F(Export, TakesTheVerdictAsTheSessionKeepsItWhileItHolds) {
  // Nothing has changed since the session's pages were made: they are the package's pages.
  EXPECT_THAT(whole_.err, Not(HasSubstr("worked out anew")));
  const std::string kept = bytes_of(at("session") / "export" / "checklist.html");
  EXPECT_FALSE(kept.empty());
  EXPECT_TRUE(bytes_of(data("report/checklist.html")) == kept);

  fs::copy(at("session"), at("less"), fs::copy_options::recursive);
  ASSERT_EQ(run_command({"session", "drop", at("less").string(), "2"}).status, 0);
  const Outcome less = run_command({"export", at("less").string(), "--to", at("less bag").string(), "--json",
                                    "--without", "renderings,features,wedges"});
  ASSERT_EQ(less.status, 0) << less.err;
  EXPECT_THAT(less.err, HasSubstr("worked out anew"));
  EXPECT_EQ(less.json()["scans"], 3) << "what was taken out is kept";
  const fs::path root = at("less bag") / "data";
  EXPECT_EQ(read_poses(root / "scans" / "poses.json")->size(), 2U);
  EXPECT_FALSE(bytes_of(root / "report" / "checklist.html") == kept);
  const auto list = nlohmann::json::parse(bytes_of(root / "scans" / "scans.json"));
  EXPECT_EQ(list["scans"][2]["taken_out"], true);
}

TEST_F(Export, FindsItsWorkDoneUntilTheSessionOrThePackageChanges) {
  const std::vector<std::string> small{"--without", "renderings,features,wedges,grid-ply"};
  const Outcome first = export_to("found", small);
  ASSERT_EQ(first.status, 0) << first.err;
  const auto written = fs::last_write_time(at("found") / "manifest-sha512.txt");
  const Outcome found = export_to("found", small);
  EXPECT_EQ(found.status, 0) << found.err;
  EXPECT_EQ(found.json()["done_before"], true);
  EXPECT_EQ(fs::last_write_time(at("found") / "manifest-sha512.txt"), written);
  std::ofstream(at("found") / "data" / "README.txt", std::ios::app) << "something else";
  EXPECT_EQ(export_to("found", small).status, 2) << "not what was written: it is not made anew unasked";
}

/// What the provenance of a package says of a step.
std::string program_of(const fs::path& bag, const std::string& step) {
  const auto graph = nlohmann::json::parse(bytes_of(bag / "data/provenance.jsonld"))["@graph"];
  const auto node = [&](const std::string& ends) {
    const auto at = std::ranges::find_if(
        graph, [&](const nlohmann::json& n) { return n["@id"].get<std::string>().ends_with(ends); });
    return at == graph.end() ? nlohmann::json() : *at;
  };
  return node(node("provenance/" + step)["crmdig:L23_used_software_or_firmware"]["@id"])["rdfs:label"]
      .get<std::string>();
}

/// Of a session: version 0.0.9 came to its verdict.
void scanned_by_another(const fs::path& session) {
  SessionStore store = SessionStore::open(session).value();
  nlohmann::json run = nlohmann::json::parse(*store.load_document("run").value());
  run["program"] = "Dubsar 0.0.9";
  ASSERT_TRUE(store.save_document("run", run.dump()));
}

TEST_F(Export, WhatWasCopiedIsThatOfTheProgramThatMadeIt) {
  const fs::path session = at("of_old");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  scanned_by_another(session);
  ASSERT_EQ(run_command({"export", session.string(), "--to", at("old_bag").string(), "--without",
                         "renderings,features,grid-ply"})
                .status,
            0);
  const auto program = [&](const std::string& step) { return program_of(at("old_bag"), step); };
  EXPECT_EQ(program("registration"), "Dubsar 0.0.9");
  EXPECT_EQ(program("verdict"), "Dubsar 0.0.9");
  EXPECT_NE(program("packing"), "Dubsar 0.0.9");
  const auto wedges = nlohmann::json::parse(bytes_of(at("old_bag") / "data/wedges/wedges.json"));
  EXPECT_EQ(program("analysis"), wedges["program"].get<std::string>()) << "they say themselves who measured";
  EXPECT_NE(program("analysis"), "Dubsar 0.0.9");
}

/// `dubsar register` of another version than the one that scanned, for one.
TEST_F(Export, TheRegistrationIsOfTheProgramThatPlacedTheScansLast) {
  const fs::path session = at("placed_anew");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  scanned_by_another(session);
  ASSERT_TRUE(SessionStore::open(session).value().save_document("programs", R"({"placed":"Dubsar 0.0.10"})"));
  ASSERT_EQ(run_command({"export", session.string(), "--to", at("placed_bag").string(), "--without",
                         "renderings,features,wedges,grid-ply"})
                .status,
            0);
  EXPECT_EQ(program_of(at("placed_bag"), "registration"), "Dubsar 0.0.10");
  EXPECT_EQ(program_of(at("placed_bag"), "verdict"), "Dubsar 0.0.9");
}

/// Killed in the very step between taking its place and whatever else it would do, it has to be found done.
TEST_F(Export, TheStampIsThereBeforeThePackageIs) {
  const fs::path to = at("stamped");
  const fs::path stamp = at("stamped.done");
  test::RunningCommand running({"export", at("session").string(), "--to", to.string() + "/", "--without",
                                "renderings,features,wedges,grid-ply"});
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!fs::exists(to) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  running.send(SIGKILL);
  EXPECT_TRUE(fs::exists(stamp)) << "the package must not be there without its stamp";
  (void)running.wait();
  EXPECT_FALSE(fs::exists(to / ".done"));
  const Outcome found = export_to("stamped", {"--without", "renderings,features,wedges,grid-ply"});
  EXPECT_EQ(found.status, 0) << found.err;
  EXPECT_EQ(found.json()["done_before"], true);
}

TEST_F(Export, IsNotThereUntilItIsWhole) {
  const fs::path to = at("stopped");
  test::RunningCommand running({"export", at("session").string(), "--to", to.string()});
  ASSERT_TRUE(running.says("packing scans")) << running.log_until_now();
  running.send(SIGKILL);
  EXPECT_EQ(running.wait().signal, SIGKILL);
  EXPECT_FALSE(fs::exists(to));
  test::RunningCommand stopped({"export", at("session").string(), "--to", to.string()});
  ASSERT_TRUE(stopped.says("packing scans")) << stopped.log_until_now();
  stopped.send(SIGINT);
  EXPECT_EQ(stopped.wait().status, 1);
  EXPECT_FALSE(fs::exists(to));
  for (const auto& entry : fs::directory_iterator(folder_->path())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("dubsar-tmp"))) << "nothing is left behind";
  }
  EXPECT_EQ(run_command({"export", at("session").string(), "--to", to.string(), "--without",
                         "renderings,features,wedges,grid-ply"})
                .status,
            0);
}

TEST_F(Export, BadUsageIsToldInOneLine) {
  EXPECT_EQ(run_command({"export", at("session").string()}).status, 2);
  EXPECT_EQ(run_command({"export", at("nowhere").string(), "--to", at("x").string()}).status, 2);
  EXPECT_EQ(export_to("x", {"--without", "everything"}).status, 2);
  const Outcome astray = export_to("none/../x", {});
  EXPECT_EQ(astray.status, 2) << "which the system would refuse";
  EXPECT_THAT(astray.err, HasSubstr("there is no folder to go up from"));
  for (const char* url :
       {"museum.example/t", "https://museum.example/a tablet/", "https://museum.example/?t=", "https://",
        "http:///x", "https://:80/", "https://@/x", "https://museum.example/%zz", "https://museum.example/%2",
        "https://museum.example:99999/", "https://museum.example:port/", "https://[::1/t", "https://a]b/"}) {
    const Outcome refused = export_to("x", {"--base-url", url});
    EXPECT_EQ(refused.status, 2) << url;
    EXPECT_THAT(refused.err, HasSubstr("--base-url: an address")) << url;
  }
  EXPECT_FALSE(fs::exists(at("x")));
}

TEST_F(Export, EveryFileOfThePackageHasItsProvenance) {
  const std::string told = bytes_of(data("provenance.jsonld"));
  for (const std::string& name : files_below(at("bag") / "data")) {
    if (!name.starts_with("formats/")) {  // the same in every package
      EXPECT_THAT(told, HasSubstr("\"https://example.org/t/" + name + "\""));
    }
  }
}

TEST_F(Export, PagesSayWhichTabletItIsEvenWhenThatWasSaidAfterTheScan) {
  fs::copy(at("session"), at("described"), fs::copy_options::recursive);
  ASSERT_EQ(run_command({"session", "describe", at("described").string(), "--museum-number", "BM 12345",
                         "--cdli", "P123456", "--collection", "A <house>"})
                .status,
            0);
  const Outcome done = run_command(
      {"export", at("described").string(), "--to", at("described_bag").string(), "--without", "renderings"});
  ASSERT_EQ(done.status, 0) << done.err;
  for (const auto& [page, kind] :
       {std::pair{"report.html", "scan report"}, std::pair{"checklist.html", "checklist"}}) {
    const std::string text = bytes_of(at("described_bag") / "data/report" / page);
    EXPECT_THAT(text, HasSubstr("<title>P123456: " + std::string(kind) + "</title>"));
    EXPECT_THAT(text, HasSubstr("<h1>P123456</h1>"));
    EXPECT_THAT(text, HasSubstr("<dt>Museum number</dt><dd>BM 12345</dd>"));
    EXPECT_THAT(text, HasSubstr("<dd>A &lt;house&gt;</dd>"));
    // The session's own, which are printed and signed, say so too.
    const std::string own = bytes_of(at("described") / "export" / page);
    EXPECT_THAT(own, HasSubstr("<title>BM 12345: " + std::string(kind) + "</title>"));
    EXPECT_THAT(own, HasSubstr("<dt>CDLI number</dt><dd>P123456</dd>"));
  }
  EXPECT_EQ(run_command({"verify", at("described").string()}).status, 0);
}

TEST_F(Export, APageThatIsDamagedDoesNotBecomeWholeByANumber) {
  fs::copy(at("session"), at("damaged"), fs::copy_options::recursive);
  const fs::path page = at("damaged") / "export/report.html";
  std::string text = bytes_of(page);
  text.back() = '!';
  std::ofstream(page, std::ios::binary) << text;
  EXPECT_EQ(run_command({"session", "describe", at("damaged").string(), "--museum-number", "BM 1"}).status,
            0);
  EXPECT_TRUE(bytes_of(page) == text);
  EXPECT_THAT(bytes_of(at("damaged") / "export/checklist.html"), HasSubstr("<h1>BM 1</h1>"));
  EXPECT_EQ(run_command({"verify", at("damaged").string()}).status, 1);
}

}  // namespace
}  // namespace dubsar
