// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a person says in the viewer is kept, whatever another program or the disk does meanwhile.

#include "station/mesh_viewing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "acquisition/session_store.h"
#include "core/inside_out.h"
#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "formats/selections_json.h"
#include "formats/wedges_json.h"
#include "sim/tablet.h"
#include "station/analysis.h"
#include "station/analysis_asked.h"
#include "station/done_stamp.h"
#include "station/tablet_record.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

void settle(const MeshViewing& viewing) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!viewing.state().stage.empty() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// A mesh that is looked at, and waited for.
class Viewer {
 public:
  explicit Viewer(const fs::path& mesh) : viewing_([] {}) { open(mesh); }
  void open(const fs::path& mesh) {
    viewing_.open(mesh);
    settle();
  }
  void remove_wedge(const Eigen::Vector3d& at_mm) {
    WedgeCorrection gone;
    gone.at_mm = {at_mm};
    viewing_.correct(gone);
    settle();
  }
  void find_wedges() {
    viewing_.analyse();
    settle();
  }
  void undo() {
    viewing_.undo_correction();
    settle();
  }
  void keep(const std::string& name) {
    viewing_.keep_selection({name, MeshElement::kFace, {{0, 3}}});
    settle();
  }
  [[nodiscard]] ViewedMesh state() const { return viewing_.state(); }

 private:
  void settle() const { dubsar::settle(viewing_); }
  MeshViewing viewing_;
};

class MeshViewingTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    sim::TabletOptions options;
    options.seed = 5;
    options.size_mm = {14, 11, 8};
    options.spacing_mm = 0.2;
    JobContext job;
    tablet_ = new Mesh(sim::make_tablet(options, job)->mesh);
    const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
    ASSERT_TRUE(analysis);
    for (const Wedge& wedge : analysis->set.wedges) {
      wedges_mm_.push_back(wedge.depth_point_mm);
    }
    ASSERT_GT(wedges_mm_.size(), 1U);
  }
  static void TearDownTestSuite() { delete tablet_; }
  void SetUp() override {
    fs::create_directories(mesh_.parent_path());
    ASSERT_TRUE(write_mesh(mesh_, *tablet_));
  }
  [[nodiscard]] std::size_t noted() const { return read_corrections(corrections_)->corrections.size(); }

  static Mesh* tablet_;
  static std::vector<Eigen::Vector3d> wedges_mm_;
  test::TemporaryFolder folder_;
  fs::path mesh_ = folder_.path() / "mesh" / "tablet.ply";
  fs::path corrections_ = folder_.path() / "mesh" / "tablet.wedges.corrections.json";
};
Mesh* MeshViewingTest::tablet_ = nullptr;
std::vector<Eigen::Vector3d> MeshViewingTest::wedges_mm_;

TEST_F(MeshViewingTest, NumbersThatAreNoMillimetresAreTold) {
  const auto said_of = [this](double factor, const char* header) {
    Mesh scaled = *tablet_;  // 20 mm across
    for (Eigen::Vector3f& p : scaled.positions) {
      p *= static_cast<float>(factor);
    }
    EXPECT_TRUE(write_mesh(mesh_, scaled));
    std::string bytes = *read_whole_file(mesh_);
    for (std::size_t at; header == nullptr && (at = bytes.find("obj_info")) != std::string::npos;) {
      bytes.erase(at, bytes.find('\n', at) + 1 - at);  // as another program writes it
    }
    EXPECT_TRUE(write_file_atomically(mesh_, bytes));
    const ViewedMesh state = Viewer(mesh_).state();
    return state.error ? state.error->line() : std::string();
  };
  EXPECT_THAT(said_of(0.1, nullptr), HasSubstr("perhaps its numbers are cm"));
  EXPECT_THAT(said_of(0.1, nullptr), HasSubstr("mesh convert --unit cm makes"));
  EXPECT_THAT(said_of(0.04, nullptr), HasSubstr("cm, in"));
  EXPECT_THAT(said_of(0.001, nullptr), HasSubstr("perhaps its numbers are m;"));
  EXPECT_THAT(said_of(1000, nullptr), HasSubstr("perhaps its numbers are um"));
  EXPECT_EQ(said_of(1, nullptr), "");
  EXPECT_EQ(said_of(0.2, "ours"), "") << "a part of a tablet whose file says its unit";
  EXPECT_THAT(said_of(0.05, "ours"), HasSubstr("perhaps its numbers are")) << "whatever it says";
}

TEST_F(MeshViewingTest, AGlbIsInMetresHoweverItIsCalled) {
  Mesh part = *tablet_;
  for (Eigen::Vector3f& p : part.positions) {
    p *= 0.2F;  // 4 mm across
  }
  for (const char* name : {"a.glb", "A.GLB"}) {
    const fs::path file = mesh_.parent_path() / name;
    ASSERT_TRUE(write_mesh(file, part)) << name;
    const ViewedMesh state = Viewer(file).state();
    EXPECT_FALSE(state.error) << state.error->line();
  }
}

TEST_F(MeshViewingTest, WhatIsDoubtedInTheWedgesIsToldAsTheCommandTellsIt) {
  Viewer viewer(mesh_);  // of a spacing of 0.2 mm
  EXPECT_THAT(viewer.state().doubts, SizeIs(0)) << "no wedges are known";
  viewer.find_wedges();
  ASSERT_FALSE(viewer.state().doubts.empty());
  EXPECT_THAT(viewer.state().doubts.back().line(), StartsWith("too coarse for wedges of the usual size"));
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_FALSE(viewer.state().doubts.empty()) << "it is as coarse as it was";

  WedgeFile file;
  file.mesh = "tablet.ply";
  file.text_from_model = RigidTransform();
  file.wedges.resize(60);
  ASSERT_TRUE(write_wedges(mesh_.parent_path() / "tablet.wedges.json", file));
  fs::remove(corrections_);
  viewer.open(mesh_);
  ASSERT_THAT(viewer.state().doubts, SizeIs(1));
  EXPECT_THAT(viewer.state().doubts[0].line(),
              StartsWith("no direction of writing shows in the 60 wedges that were found"));
  fs::remove(mesh_.parent_path() / "tablet.wedges.json");
  viewer.open(mesh_);
  EXPECT_THAT(viewer.state().doubts, SizeIs(0)) << "of other wedges";
}

TEST_F(MeshViewingTest, ACorrectionThatAnotherProgramMadeMeanwhileStays) {
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

TEST_F(MeshViewingTest, CorrectionsThatCannotBeReadAreNotWrittenOver) {
  std::ofstream(corrections_) << "{\"corrections\":[";
  Viewer viewer(mesh_);
  ASSERT_TRUE(viewer.state().error);
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_TRUE(viewer.state().error);
  EXPECT_EQ(*read_whole_file(corrections_), "{\"corrections\":[");
  viewer.keep("another thing");
  EXPECT_FALSE(viewer.state().error) << "the refusal is of what was asked for before";
}

TEST_F(MeshViewingTest, NothingIsNotedWhenTheWedgesCannotBeWritten) {
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

TEST_F(MeshViewingTest, WhatIsSaidOfASessionsMeshIsKeptWithItsWedges) {
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

TEST_F(MeshViewingTest, AnothersWedgesInTheFolderAreLeftAlone) {
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

TEST_F(MeshViewingTest, WedgesOfWhichNobodyKnowsTheMeshAreSaidAndLeftAlone) {
  const fs::path shared = mesh_.parent_path() / "wedges.json";
  std::ofstream(shared) << "{\"wedges\":[";
  Viewer viewer(mesh_);
  EXPECT_TRUE(viewer.state().error);
  viewer.remove_wedge(wedges_mm_[0]);
  EXPECT_EQ(*read_whole_file(shared), "{\"wedges\":[");
  EXPECT_EQ(noted(), 1U) << "with a file of its own";
}

TEST_F(MeshViewingTest, AMeshBesideASessionsOwnHasWedgesOfItsOwn) {
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

TEST_F(MeshViewingTest, NothingIsLaidIntoAPackage) {
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

TEST_F(MeshViewingTest, ACorrectionMeasuresAsTheWedgesWereMeasured) {
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

TEST_F(MeshViewingTest, ACorrectionLeavesTheOthersTheIdsThatTheyHad) {
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

TEST_F(MeshViewingTest, WhatIsKeptOfASessionsMeshSaysWhatTheSessionSays) {
  const fs::path session = folder_.path() / "session";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    TabletRecord record;
    record.museum_number = "BM 15285";
    record.rights = "CC BY 4.0";
    ASSERT_TRUE(keep_tablet_record(store, record));
    RangeGrid made_up;
    made_up.rows = 2;
    made_up.cols = 2;
    made_up.x = {0, 0.1F, 0, 0.1F};
    made_up.y = {0, 0, 0.1F, 0.1F};
    made_up.z = {0, 0, 0, 0};
    made_up.valid = {1, 1, 1, 1};
    made_up.spacing_mm = 0.1;
    made_up.device = "sim";
    ASSERT_TRUE(store.add_grid(made_up));
  }
  MeshViewing viewing([] {});
  viewing.show(std::make_shared<const Mesh>(*tablet_), {}, session / "analysis" / "wedges.json");
  settle(viewing);
  ASSERT_FALSE(viewing.state().error) << viewing.state().error->line();
  const fs::path part = folder_.path() / "part.ply";
  viewing.write_part({"all", MeshElement::kFace, {{0, 3}}}, part);
  settle(viewing);
  const FileLabel label = read_mesh_label(part);
  EXPECT_TRUE(label.simulated);
  EXPECT_THAT(label.name, HasSubstr("BM 15285"));
  EXPECT_THAT(label.rights, HasSubstr("CC BY 4.0"));
  // What is looked at next is another one's.
  viewing.open(mesh_);
  settle(viewing);
  viewing.write_part({"all", MeshElement::kFace, {{0, 3}}}, part);
  settle(viewing);
  EXPECT_TRUE(read_mesh_label(part).empty());
}

TEST_F(MeshViewingTest, AMeshThatIsInsideOutIsTurnedOverWithAWord) {
  Mesh turned = *tablet_;
  turn_over(&turned);
  ASSERT_TRUE(write_mesh(mesh_, turned));
  Viewer one(mesh_);
  ASSERT_TRUE(one.state().error);
  EXPECT_THAT(one.state().error->line(), testing::HasSubstr("inside out"));
  EXPECT_THAT(one.state().error->line(), testing::HasSubstr("turned over"));
  ASSERT_TRUE(one.state().mesh);
  EXPECT_EQ(one.state().mesh->faces, tablet_->faces);
  // So that a cut is of the side that is seen.
  MeshViewing viewing([] {});
  viewing.open(mesh_);
  settle(viewing);
  viewing.cut({-4, 0, 4}, {4, 0, 4}, Eigen::Vector3d::UnitZ());
  settle(viewing);
  const Result<CrossSection> as_it_was =
      cross_section(*tablet_, {-4, 0, 4}, {4, 0, 4}, Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(as_it_was);
  ASSERT_TRUE(viewing.state().section);
  EXPECT_NEAR(viewing.state().section->lowest_mm, as_it_was->lowest_mm, 1e-6);
}

TEST_F(MeshViewingTest, TwoWhoSelectOnOneMeshLoseNothing) {
  Viewer one(mesh_);
  Viewer other(mesh_);
  one.keep("line 1");
  other.keep("line 2");
  EXPECT_FALSE(other.state().error) << other.state().error->line();
  EXPECT_THAT(read_selections(mesh_.parent_path() / "tablet.selections.json")->selections, SizeIs(2));
  EXPECT_THAT(*other.state().selections, SizeIs(2));
}

TEST_F(MeshViewingTest, ACutThatIsAskedForTakesThePlaceOfTheLastAtOnce) {
  std::mutex gate;  // closed, the worker comes no farther
  MeshViewing viewing([&] { const std::scoped_lock passing(gate); });
  viewing.open(mesh_);
  settle(viewing);
  const Eigen::Vector3d a(-4, 0, 4), b(4, 0, 4), c(4, 2, 4);
  viewing.cut(a, b, Eigen::Vector3d::UnitZ());
  settle(viewing);
  ASSERT_TRUE(viewing.state().section);
  const fs::path stem = folder_.path() / "cut";
  {
    const std::scoped_lock closed(gate);
    viewing.want(MeshField::kMeanCurvature);
    viewing.cut(a, c, Eigen::Vector3d::UnitZ());
    EXPECT_FALSE(viewing.state().section) << "of other places";
    EXPECT_TRUE(viewing.state().section_due);
    viewing.keep_section(stem);
    viewing.stop();
    EXPECT_FALSE(viewing.state().section_due);
  }
  settle(viewing);
  EXPECT_FALSE(viewing.state().section);
  EXPECT_TRUE(viewing.state().written.empty());
  // Asked for again it is there; of two that wait the last one is.
  {
    const std::scoped_lock closed(gate);
    viewing.cut(a, b, Eigen::Vector3d::UnitZ());
    viewing.cut(a, c, Eigen::Vector3d::UnitZ());
  }
  settle(viewing);
  ASSERT_TRUE(viewing.state().section);
  EXPECT_FALSE(viewing.state().section_due);
  EXPECT_NEAR(viewing.state().section->length_mm, (c - a).norm(), 1e-6);
  // One that cannot be made leaves none.
  viewing.cut(a, a, Eigen::Vector3d::UnitZ());
  settle(viewing);
  EXPECT_FALSE(viewing.state().section);
  EXPECT_FALSE(viewing.state().section_due);
  EXPECT_TRUE(viewing.state().error);
}

TEST(MeshViewing, TheNextIsAskedForWhileSomebodyLooksAtWhatTheLastOneDid) {
  MeshViewing* looked_at = nullptr;
  std::atomic<bool> done = false;
  std::atomic<bool> asking = false;
  MeshViewing viewing([&] {
    if (!looked_at->state().stage.empty() || done.exchange(true)) {
      return;
    }
    while (!asking) {
      std::this_thread::yield();
    }
    for (int k = 0; k < 100000; ++k) {  // one of these looks meets the asking
      [[maybe_unused]] const ViewedMesh seen = looked_at->state();
    }
  });
  looked_at = &viewing;
  viewing.want(MeshField::kOpenness);
  while (!done) {
    std::this_thread::yield();
  }
  asking = true;
  viewing.want(MeshField::kOpenness);
  settle(viewing);
  EXPECT_TRUE(viewing.state().stage.empty());
}

TEST_F(MeshViewingTest, ACutIsSaidToBeKeptOnceItIsWritten) {
  MeshViewing viewing([] {});
  viewing.open(mesh_);
  settle(viewing);
  viewing.cut({-4, 0, 4}, {4, 0, 4}, Eigen::Vector3d::UnitZ());
  settle(viewing);
  viewing.keep_section(folder_.path() / "not there" / "cut");
  settle(viewing);
  ASSERT_TRUE(viewing.state().error);
  EXPECT_EQ(viewing.state().error->kind, ErrorKind::kStorage);
  EXPECT_TRUE(viewing.state().written.empty());
  viewing.keep_section(folder_.path() / "cut");
  settle(viewing);
  EXPECT_FALSE(viewing.state().error);
  ASSERT_THAT(viewing.state().written, SizeIs(2));
  for (const fs::path& file : viewing.state().written) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
}

}  // namespace
}  // namespace dubsar
