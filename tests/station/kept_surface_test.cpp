// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps of one surface: what is made anew of it, and what stays.

#include "station/kept_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/mesh_io.h"
#include "formats/sha2.h"
#include "station/results.h"
#include "station/selected_mesh.h"
#include "station/session_pages.h"
#include "station/session_wedges.h"
#include "tests/support/raster_mesh.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(WedgeSentence, CountsOneAsOne) {
  SessionWedges wedges;
  wedges.count = 1;
  wedges.rejected = 1;
  EXPECT_THAT(wedge_sentence(wedges), HasSubstr("1 wedge was measured, 1 hollow was rejected: "));
  wedges.count = 2;
  wedges.rejected = 0;
  EXPECT_THAT(wedge_sentence(wedges), HasSubstr("2 wedges were measured, 0 hollows were rejected: "));
  wedges.count = 0;
  EXPECT_THAT(wedge_sentence(wedges), HasSubstr("No wedges were found; 0 hollows were looked at."));
}

TEST(KeptSurface, ALostDrawingIsOfTheWedgesAsTheyAre) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
  const Mesh mesh = test::blank_square();
  ASSERT_TRUE(write_mesh(store.folder() / kSessionMesh, mesh));
  // Nobody could measure this one on that mesh.
  WedgeFile file;
  file.mesh = "../mesh/model.ply";
  file.text_from_model = RigidTransform();
  Wedge& wedge = file.wedges.emplace_back();
  wedge.id = 41;
  wedge.place.side = Face::kObverse;
  ASSERT_TRUE(
      store.replace_file("analysis/wedges.json", [&](const auto& to) { return write_wedges(to, file); }));
  const auto put = [](const auto& to) { return write_file_atomically(to, std::string_view("as it was")); };
  ASSERT_TRUE(store.replace_file("analysis/reverse.svg", put));
  const auto bytes = [&](const char* name) { return read_whole_file(store.folder() / name).value(); };
  const std::string wedges = bytes("analysis/wedges.json");
  JobContext job;
  const Result<bool> made = make_wedges_anew(store, {"analysis/obverse.svg"}, job);
  ASSERT_TRUE(made) << made.error().line();
  EXPECT_THAT(bytes("analysis/obverse.svg"), ::testing::HasSubstr("41"));
  EXPECT_EQ(bytes("analysis/reverse.svg"), "as it was");
  EXPECT_EQ(bytes("analysis/wedges.json"), wedges);
  EXPECT_THAT(store.verify(job).value().whole, ::testing::Contains("analysis/obverse.svg"));
}

/// The session keeps these as the wedges of `mesh`.
void keep(SessionStore& store, const Mesh& mesh, const WedgeFile& file) {
  ASSERT_TRUE(keep_wedges(store, mesh, {}).value());
  ASSERT_TRUE(
      store.replace_file("analysis/wedges.json", [&](const auto& to) { return write_wedges(to, file); }));
  nlohmann::json noted = nlohmann::json::parse(store.load_document("wedges").value().value());
  noted["sha256"] = sha256_of_file(store.folder() / "analysis/wedges.json", {}).value();
  ASSERT_TRUE(store.save_document("wedges", noted.dump()));
}

TEST(KeptSurface, OfWedgesThatAreKeptPagesTellWhatTheyToldWhenTheyWereMeasured) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
  const Mesh mesh = test::blank_square();
  WedgeFile file;
  file.text_from_model = RigidTransform();
  file.text_certainty = 0.7;
  file.wedges.resize(6);
  for (Wedge& wedge : file.wedges) {
    wedge.depth_mm = 0.25;
  }
  file.wedges.front().intact = 0.5;
  keep(store, mesh, file);
  PageFacts facts;
  tell_kept_wedges(facts, store, mesh, {});
  EXPECT_EQ(facts.wedges, "") << "nobody looked for them in the last run";
  facts.wedges = "as it was";
  tell_kept_wedges(facts, store, mesh, {});
  EXPECT_THAT(facts.wedges, ::testing::StartsWith("6 wedges were measured"));
  EXPECT_THAT(facts.wedges, Not(HasSubstr("direction of writing"))) << "it shows";
  ASSERT_EQ(facts.wedge_profiles.size(), 1U);
  EXPECT_EQ(facts.wedge_profiles.front().quantiles[0][4], 0.25);
  EXPECT_EQ(facts.wedge_profiles.front().known[0], 6);
  EXPECT_EQ(facts.wedge_profiles.front().known[5], 5) << "angles of those that are whole";

  EXPECT_THAT(facts.wedges, Not(HasSubstr("A person"))) << "nobody has";

  file.text_certainty = 0;
  file.corrections = 3;
  file.lost = {{1, "no wedge lies there any more"}};
  keep(store, mesh, file);
  tell_kept_wedges(facts, store, mesh, {});
  EXPECT_THAT(facts.wedges, HasSubstr("Take care: no direction of writing shows"));
  EXPECT_THAT(facts.wedges, HasSubstr("A person has corrected what was found: 2 corrections were made, and 1 "
                                      "more could not be."));

  // What was measured otherwise is none of the other mesh.
  nlohmann::json noted = nlohmann::json::parse(store.load_document("wedges").value().value());
  noted["method"] = noted["method"].get<int>() - 1;
  ASSERT_TRUE(store.save_document("wedges", noted.dump()));
  tell_kept_wedges(facts, store, mesh, {});
  EXPECT_THAT(facts.wedges, HasSubstr("are of this mesh"));
  EXPECT_EQ(kept_wedges(store, mesh), KeptWedges::kMeasuredOtherwise);

  // Of another surface nothing is told that those say.
  Mesh other = mesh;
  other.positions[0].z() = 1;
  tell_kept_wedges(facts, store, other, {});
  EXPECT_THAT(facts.wedges, ::testing::EndsWith("of the mesh as it was before."));
  EXPECT_EQ(kept_wedges(store, other), KeptWedges::kOfAnotherSurface);
  EXPECT_TRUE(facts.wedge_profiles.empty());
}

TEST(KeptSurface, PagesThatTellOfAnotherWayOfMeasuringAreTakenBackThoughTheNumberIsTheSame) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
  const Mesh mesh = test::blank_square();
  ASSERT_TRUE(write_mesh(store.folder() / kSessionMesh, mesh));
  const std::optional<SessionWedges> kept = keep_wedges(store, mesh, {}).value();
  PageFacts facts;
  tell_wedges(facts, *kept);
  ASSERT_TRUE(keep_page_facts(store, facts));
  ASSERT_TRUE(store.replace_file("export/report.html", [](const auto& to) {
    return write_file_atomically(to, std::string_view("<main>\n<p>So many wedges.</p>\n</main>"));
  }));
  JobContext job;
  ASSERT_TRUE(make_wedges_anew(store, {"analysis/wedges.json"}, job));
  EXPECT_FALSE(pages_are_taken_back(store)) << "measured as before, on the same mesh";
  nlohmann::json noted = nlohmann::json::parse(store.load_document("wedges").value().value());
  noted["method"] = noted["method"].get<int>() - 1;
  ASSERT_TRUE(store.save_document("wedges", noted.dump()));
  ASSERT_TRUE(make_wedges_anew(store, {"analysis/wedges.json"}, job));
  EXPECT_TRUE(pages_are_taken_back(store));
}

}  // namespace
}  // namespace dubsar
