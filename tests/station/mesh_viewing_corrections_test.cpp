// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a person says of wedges in the viewer is kept, whatever another program or the disk does meanwhile.

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/wedges_json.h"
#include "station/analysis_asked.h"
#include "station/done_stamp.h"
#include "station/tablet_record.h"
#include "tests/station/support/viewed_tablet.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

using test::Viewer;
using MeshViewingCorrections = test::OnAViewedTablet;

/// Asks for it and stops it while it is measured.
WedgeCorrection stop_a_deletion(MeshViewing& viewing, const fs::path& mesh, const Eigen::Vector3d& at_mm) {
  viewing.open(mesh);
  test::settle(viewing);
  WedgeCorrection gone;
  gone.at_mm = {at_mm};
  viewing.correct(gone);
  viewing.stop();
  test::settle(viewing);
  return gone;
}

TEST_F(MeshViewingCorrections, ACorrectionThatAnotherProgramMadeMeanwhileStays) {
  Viewer one(mesh_);
  Viewer other(mesh_);
  one.remove_wedge(wedges_mm_[0]);
  ASSERT_FALSE(one.state().error) << one.state().error->line();
  ASSERT_EQ(noted(), 1U);
  other.remove_wedge(wedges_mm_[1]);
  ASSERT_TRUE(other.state().error);
  EXPECT_EQ(other.state().error->kind, ErrorKind::kUsage);
  EXPECT_EQ(other.state().corrections, 0U);
  EXPECT_EQ(noted(), 1U);
  other.open(mesh_);
  EXPECT_EQ(other.state().corrections, 1U);
  other.remove_wedge(wedges_mm_[1]);
  EXPECT_EQ(noted(), 2U);
}

TEST_F(MeshViewingCorrections, CorrectionsThatCannotBeReadAreNotWrittenOver) {
  std::ofstream(corrections_) << "{\"corrections\":[";
  Viewer viewer(mesh_);
  ASSERT_TRUE(viewer.state().error);
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_TRUE(viewer.state().error);
  EXPECT_EQ(*read_whole_file(corrections_), "{\"corrections\":[");
  viewer.keep("another thing");
  EXPECT_FALSE(viewer.state().error) << "the refusal is of what was asked for before";
}

TEST_F(MeshViewingCorrections, NothingIsNotedWhenTheWedgesCannotBeWritten) {
  Viewer viewer(mesh_);
  // Room for what is noted, none for what is measured.
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &small);
  viewer.remove_wedge(wedges_mm_[0]);
  const rlimit free{RLIM_INFINITY, RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &free);
  ASSERT_TRUE(viewer.state().error);
  EXPECT_EQ(viewer.state().error->kind, ErrorKind::kStorage);
  EXPECT_EQ(viewer.state().corrections, 0U);
  EXPECT_EQ(noted(), 0U);
}

TEST_F(MeshViewingCorrections, WhatIsSaidOfASessionsMeshIsKeptWithItsWedges) {
  std::ofstream(folder_.path() / "session.sqlite") << "";
  fs::rename(mesh_, mesh_.parent_path() / "model.ply");
  mesh_ = mesh_.parent_path() / "model.ply";
  const fs::path kept = folder_.path() / "analysis" / "wedges.corrections.json";
  {
    Viewer viewer(mesh_);
    viewer.remove_wedge(wedges_mm_[0]);
    EXPECT_FALSE(viewer.state().error) << viewer.state().error->line();
  }
  EXPECT_THAT(read_corrections(kept)->corrections, SizeIs(1));
  EXPECT_EQ(std::distance(fs::directory_iterator(mesh_.parent_path()), fs::directory_iterator()), 1);
  // Also before the session has measured any.
  EXPECT_EQ(Viewer(mesh_).state().corrections, 1U);
}

TEST_F(MeshViewingCorrections, WedgesOfASessionsMeshStayWhereItIsLookedAtAgain) {
  const auto model = std::make_shared<const Mesh>(*tablet_);
  const fs::path wedges = folder_.path() / "analysis" / "wedges.json";
  MeshViewing viewing([] {});
  const auto look = [&](const std::shared_ptr<const Mesh>& at) {
    viewing.show(at, {}, wedges);
    test::settle(viewing);
  };
  look(model);
  viewing.analyse();
  test::settle(viewing);
  WedgeCorrection gone;
  gone.at_mm = {wedges_mm_[0]};
  viewing.correct(gone);
  test::settle(viewing);
  const ViewedMesh before = viewing.state();
  ASSERT_TRUE(before.wedges);
  ASSERT_EQ(before.corrections, 1U);
  look(model);
  EXPECT_EQ(viewing.state().wedges, before.wedges) << "they would be measured again";
  EXPECT_EQ(viewing.state().number, before.number);
  EXPECT_EQ(viewing.state().corrections, 1U);
  // Not where another program has taken the correction back, nor of another model.
  ASSERT_TRUE(write_corrections(corrections_file_of(wedges), {"model.ply", {}}));
  look(model);
  EXPECT_FALSE(viewing.state().wedges);
  EXPECT_EQ(viewing.state().corrections, 0U);
  look(std::make_shared<const Mesh>(*tablet_));
  EXPECT_EQ(viewing.state().number, before.number + 2);
}

TEST_F(MeshViewingCorrections, AnothersWedgesInTheFolderAreLeftAlone) {
  const JobContext job;
  const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
  ASSERT_TRUE(analysis);
  const fs::path shared = mesh_.parent_path() / "wedges.json";
  ASSERT_TRUE(write_wedges(shared, wedge_file("../elsewhere/tablet.ply", {}, *analysis)));
  const std::string before = *read_whole_file(shared);
  const fs::path neighbour = mesh_.parent_path() / "neighbour.ply";
  ASSERT_TRUE(write_mesh(neighbour, *tablet_));
  {
    Viewer viewer(neighbour);
    EXPECT_FALSE(viewer.state().wedges) << "they are of tablet.ply";
    EXPECT_FALSE(viewer.state().error);
    viewer.remove_wedge(wedges_mm_[0]);
    EXPECT_FALSE(viewer.state().error) << viewer.state().error->line();
  }
  EXPECT_EQ(*read_whole_file(shared), before);
  EXPECT_FALSE(fs::exists(mesh_.parent_path() / "wedges.corrections.json"));
  const Result<WedgeFile> own = read_wedges(mesh_.parent_path() / "neighbour.wedges.json");
  ASSERT_TRUE(own);
  EXPECT_EQ(own->mesh, "neighbour.ply");
  EXPECT_EQ(own->corrections, 1U);
  // Whoever they are of sees and corrects them there.
  Viewer viewer(mesh_);
  ASSERT_TRUE(viewer.state().wedges);
  EXPECT_THAT(*viewer.state().wedges, SizeIs(wedges_mm_.size()));
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_EQ(read_wedges(shared)->corrections, 1U);
}

TEST_F(MeshViewingCorrections, WedgesOfWhichNobodyKnowsTheMeshAreSaidAndLeftAlone) {
  const fs::path shared = mesh_.parent_path() / "wedges.json";
  std::ofstream(shared) << "{\"wedges\":[";
  Viewer viewer(mesh_);
  EXPECT_TRUE(viewer.state().error);
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_EQ(*read_whole_file(shared), "{\"wedges\":[");
  EXPECT_EQ(noted(), 1U) << "with a file of its own";
}

TEST_F(MeshViewingCorrections, AMeshBesideASessionsOwnHasWedgesOfItsOwn) {
  std::ofstream(folder_.path() / "session.sqlite") << "";
  const JobContext job;
  const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
  const fs::path of_session = folder_.path() / "analysis" / "wedges.json";
  fs::create_directories(of_session.parent_path());
  ASSERT_TRUE(write_wedges(of_session, wedge_file("../mesh/model.ply", {}, *analysis)));
  Viewer viewer(mesh_);
  EXPECT_FALSE(viewer.state().wedges);
  const fs::path model = mesh_.parent_path() / "model.ply";
  ASSERT_TRUE(write_mesh(model, *tablet_));
  viewer.open(model);
  EXPECT_TRUE(viewer.state().wedges);
}

TEST_F(MeshViewingCorrections, NothingIsLaidIntoAPackage) {
  std::ofstream(folder_.path() / "bagit.txt") << "BagIt-Version: 1.0\n";
  Viewer one(mesh_);
  one.keep("line 1");
  ASSERT_TRUE(one.state().error);
  EXPECT_THAT(one.state().error->line(), testing::HasSubstr("a package keeps a checksum"));
  Viewer other(mesh_);
  other.remove_wedge(wedges_mm_[0]);
  ASSERT_TRUE(other.state().error);
  EXPECT_EQ(other.state().corrections, 0U);
  EXPECT_EQ(std::distance(fs::directory_iterator(mesh_.parent_path()), {}), 1) << "the mesh alone";
}

TEST_F(MeshViewingCorrections, ACorrectionMeasuresAsTheWedgesWereMeasured) {
  const JobContext job;
  AnalysisAsked asked;
  asked.fields.reliability_iterations = 6;
  asked.fields.free_surface.least_openness = 0.8;
  asked.uniform_weights = true;
  const Result<Analysis> analysis = analyze_mesh(*tablet_, options_of(asked, {}), job);
  ASSERT_TRUE(analysis);
  const fs::path file = mesh_.parent_path() / "tablet.wedges.json";
  const WedgeFile before = wedge_file("tablet.ply", {}, *analysis);
  ASSERT_GT(before.wedges.size(), 1U);
  ASSERT_TRUE(write_wedges(file, before));
  ASSERT_NE((before.wedges[0].depth_point_mm - wedges_mm_[0]).norm(), 0) << "else nothing is shown here";
  const nlohmann::json parameters{{"exit", "surface"},
                                  {"unit", ""},
                                  {"free_openness", 0.8},
                                  {"free_concave_per_mm", asked.fields.free_surface.most_concave_per_mm},
                                  {"equalize", false},
                                  {"fault_reach", 6},
                                  {"uniform_weights", true},
                                  {"classical_watershed", false},
                                  {"mesh_out", ""},
                                  {"pictures", ""},
                                  {"svg", ""},
                                  {"invariants", ""}};
  const DoneStamp stamp{"Dubsar", "analyze", parameters.dump(), {}, {}};
  ASSERT_TRUE(write_file_atomically(stamp_beside(file), done_stamp_to_json(stamp)));
  Viewer viewer(mesh_);
  viewer.remove_wedge(before.wedges[0].depth_point_mm);
  ASSERT_FALSE(viewer.state().error) << viewer.state().error->line();
  const Result<WedgeFile> after = read_wedges(file);
  const Result<WedgeFile> as_read = parse_wedges(wedges_to_json(before), "");
  ASSERT_EQ(after->wedges.size() + 1, before.wedges.size());
  for (std::size_t i = 0; i < after->wedges.size(); ++i) {
    EXPECT_EQ(after->wedges[i].id, as_read->wedges[i + 1].id);
    EXPECT_EQ(after->wedges[i].depth_point_mm, as_read->wedges[i + 1].depth_point_mm);
    EXPECT_EQ(after->wedges[i].volume_mm3, as_read->wedges[i + 1].volume_mm3);
  }
}

TEST_F(MeshViewingCorrections, ACorrectionLeavesTheOthersTheIdsThatTheyHad) {
  const JobContext job;
  const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
  const fs::path file = mesh_.parent_path() / "tablet.wedges.json";
  WedgeFile before = wedge_file("tablet.ply", {}, *analysis);
  for (Wedge& wedge : before.wedges) {
    wedge.id += 30;
  }
  ASSERT_TRUE(write_wedges(file, before));
  Viewer viewer(mesh_);
  viewer.remove_wedge(before.wedges[0].depth_point_mm);
  ASSERT_FALSE(viewer.state().error) << viewer.state().error->line();
  const WedgeFile after = *read_wedges(file);
  ASSERT_THAT(after.wedges, SizeIs(before.wedges.size() - 1));
  EXPECT_EQ(after.wedges.front().id, 31);
  EXPECT_EQ(viewer.state().wedges->front().id, 31);
  ASSERT_THAT(after.former, SizeIs(1));
  EXPECT_EQ(after.former.front().id, 30);
  viewer.undo();
  EXPECT_EQ(read_wedges(file)->wedges.front().id, 30);
  EXPECT_THAT(read_wedges(file)->former, SizeIs(0));
}

TEST_F(MeshViewingCorrections, ACorrectionOfAPartLeavesTheOthersTheIdsThatTheyHad) {
  const JobContext job;
  const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
  const fs::path file = folder_.path() / "part.wedges.json";
  WedgeFile before = wedge_file("part.ply", {}, *analysis);
  for (Wedge& wedge : before.wedges) {
    wedge.id += 30;
  }
  ASSERT_TRUE(write_wedges(file, before));
  MeshViewing viewing([] {});
  viewing.open(mesh_);
  test::settle(viewing);
  const auto faces = static_cast<std::uint32_t>(tablet_->faces.size());
  viewing.analyse_part({"all", MeshElement::kFace, {{0, faces}}}, folder_.path() / "part");
  test::settle(viewing);
  ASSERT_TRUE(viewing.state().wedges);
  ASSERT_EQ(viewing.state().wedges->front().id, 30);
  WedgeCorrection gone;
  gone.at_mm = {viewing.state().wedges->front().depth_point_mm};
  viewing.correct(gone);
  test::settle(viewing);
  ASSERT_FALSE(viewing.state().error) << viewing.state().error->line();
  EXPECT_EQ(viewing.state().wedges->front().id, 31);
  EXPECT_EQ(read_wedges(file)->wedges.front().id, 31);
}

/// Whoever closes the window or stops has said it all the same.
TEST_F(MeshViewingCorrections, OneThatIsClosedWhileItIsMeasuredIsNotedAndMadeAtTheNextOpening) {
  const fs::path file = mesh_.parent_path() / "tablet.wedges.json";
  const auto said_and_closed = [this](auto say) {
    MeshViewing viewing([] {});
    viewing.open(mesh_);
    test::settle(viewing);
    say(viewing);
  };
  WedgeCorrection gone;
  gone.at_mm = {wedges_mm_[0]};
  said_and_closed([&](MeshViewing& viewing) { viewing.correct(gone); });
  EXPECT_EQ(noted(), 1U);
  EXPECT_FALSE(fs::exists(file)) << "else it was not closed in the midst";
  {
    Viewer viewer(mesh_);
    EXPECT_FALSE(viewer.state().error) << viewer.state().error->line();
    ASSERT_TRUE(viewer.state().wedges);
    EXPECT_THAT(*viewer.state().wedges, SizeIs(wedges_mm_.size() - 1));
    ASSERT_TRUE(read_wedges(file));
    EXPECT_EQ(read_wedges(file)->corrections, 1U);
  }
  said_and_closed([&](MeshViewing& viewing) { viewing.undo_correction(); });
  EXPECT_EQ(noted(), 0U);
  EXPECT_EQ(read_wedges(file)->corrections, 1U);
  EXPECT_THAT(*Viewer(mesh_).state().wedges, SizeIs(wedges_mm_.size()));
  EXPECT_EQ(read_wedges(file)->corrections, 0U);
  EXPECT_THAT(read_wedges(file)->wedges, SizeIs(wedges_mm_.size()));
}

/// As where one was taken back and another said, and both were stopped.
TEST_F(MeshViewingCorrections, OthersOfTheSameNumberAreMadeAtTheNextOpening) {
  const fs::path file = mesh_.parent_path() / "tablet.wedges.json";
  Viewer(mesh_).remove_wedge(wedges_mm_[0]);
  ASSERT_EQ(read_wedges(file)->corrections, 1U);
  WedgeCorrection other;
  other.at_mm = {wedges_mm_[1]};
  ASSERT_TRUE(write_corrections(corrections_, {"tablet.ply", {other}}));
  // As of copied files, whose times say nothing.
  fs::last_write_time(corrections_, fs::last_write_time(file) - std::chrono::hours(1));
  Viewer viewer(mesh_);
  EXPECT_FALSE(viewer.state().error) << viewer.state().error->line();
  ASSERT_TRUE(viewer.state().wedges);
  const WedgeFile written = *read_wedges(file);
  EXPECT_TRUE(has_corrections(written, {other}));
  for (const std::vector<Wedge>& wedges : {*viewer.state().wedges, written.wedges}) {
    EXPECT_THAT(wedges, SizeIs(wedges_mm_.size() - 1));
    const auto is_there = [&](const Eigen::Vector3d& place_mm) {
      return std::ranges::any_of(
          wedges, [&](const Wedge& wedge) { return (wedge.depth_point_mm - place_mm).norm() < 1e-6; });
    };
    EXPECT_TRUE(is_there(wedges_mm_[0]));
    EXPECT_FALSE(is_there(wedges_mm_[1]));
  }
}

TEST_F(MeshViewingCorrections, OneThatIsStoppedIsNotedSaidAndMadeWhenItIsSaidAgain) {
  MeshViewing viewing([] {});
  const WedgeCorrection gone = stop_a_deletion(viewing, mesh_, wedges_mm_[0]);
  EXPECT_EQ(noted(), 1U);
  EXPECT_EQ(viewing.state().corrections, 1U);
  ASSERT_THAT(viewing.state().not_made, SizeIs(1));
  EXPECT_THAT(viewing.state().not_made[0], StartsWith("stopped: it is noted"));
  viewing.correct(gone);
  test::settle(viewing);
  EXPECT_EQ(noted(), 1U) << "it is the same";
  EXPECT_THAT(viewing.state().not_made, SizeIs(0));
  ASSERT_TRUE(viewing.state().wedges);
  EXPECT_THAT(*viewing.state().wedges, SizeIs(wedges_mm_.size() - 1));
  EXPECT_EQ(read_wedges(mesh_.parent_path() / "tablet.wedges.json")->corrections, 1U);
}

TEST_F(MeshViewingCorrections, OneThatIsStoppedIsWrittenAlsoWhereTheNextOneCannotBeMade) {
  MeshViewing viewing([] {});
  stop_a_deletion(viewing, mesh_, wedges_mm_[0]);
  ASSERT_EQ(noted(), 1U);
  WedgeCorrection nowhere;
  nowhere.at_mm = {Eigen::Vector3d(500, 500, 500)};
  viewing.correct(nowhere);
  test::settle(viewing);
  ASSERT_THAT(viewing.state().not_made, SizeIs(1));
  EXPECT_THAT(viewing.state().not_made[0], StartsWith("no wedge lies at"));
  EXPECT_EQ(noted(), 1U);
  const Result<WedgeFile> written = read_wedges(mesh_.parent_path() / "tablet.wedges.json");
  ASSERT_TRUE(written) << "the window shows the wedges without it";
  EXPECT_EQ(written->corrections, 1U);
  EXPECT_THAT(written->wedges, SizeIs(wedges_mm_.size() - 1));
}

/// What was done by hand is not measured away because its note went astray.
TEST_F(MeshViewingCorrections, WedgesWhoseNoteIsNotThereOrDamagedStay) {
  const fs::path file = mesh_.parent_path() / "tablet.wedges.json";
  Viewer(mesh_).remove_wedge(wedges_mm_[0]);
  const std::string corrected = *read_whole_file(file);
  fs::remove(corrections_);
  EXPECT_FALSE(Viewer(mesh_).state().error);
  EXPECT_EQ(*read_whole_file(file), corrected);
  std::ofstream(corrections_) << "{\"corrections\":[";
  EXPECT_TRUE(Viewer(mesh_).state().error);
  EXPECT_EQ(*read_whole_file(file), corrected);
}

}  // namespace
}  // namespace dubsar
