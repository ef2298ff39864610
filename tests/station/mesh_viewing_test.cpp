// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the viewer shows of a mesh, cuts and keeps of it.

#include "station/mesh_viewing.h"

#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <mutex>

#include "acquisition/session_store.h"
#include "core/inside_out.h"
#include "formats/atomic_file.h"
#include "formats/file_label_reader.h"
#include "formats/selections_json.h"
#include "formats/wedges_json.h"
#include "station/selection_store.h"
#include "station/tablet_record.h"
#include "tests/station/support/viewed_tablet.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

using test::settle;
using test::Viewer;
using MeshViewingTest = test::OnAViewedTablet;

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
    return state.mesh_doubts.empty() ? std::string() : state.mesh_doubts.front().line();
  };
  EXPECT_THAT(said_of(0.1, nullptr), HasSubstr("perhaps its numbers are cm"));
  EXPECT_THAT(said_of(0.1, nullptr), HasSubstr("mesh convert --unit cm makes"));
  EXPECT_THAT(said_of(0.04, nullptr), HasSubstr("cm, in"));
  EXPECT_THAT(said_of(0.001, nullptr), HasSubstr("perhaps its numbers are m;"));
  EXPECT_THAT(said_of(1000, nullptr), HasSubstr("perhaps its numbers are um"));
  EXPECT_EQ(said_of(1, nullptr), "");
  EXPECT_EQ(said_of(0.2, "ours"), "") << "a part of a tablet whose file says its unit";
  EXPECT_THAT(said_of(100, nullptr), HasSubstr("no unit makes a tablet of it: it is ")) << "2 m";
  EXPECT_EQ(said_of(100, "ours"), "") << "an inscribed rock";
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
    EXPECT_THAT(state.mesh_doubts, SizeIs(0)) << state.mesh_doubts.front().line();
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
  ASSERT_THAT(one.state().mesh_doubts, SizeIs(1));
  EXPECT_THAT(one.state().mesh_doubts[0].line(), testing::HasSubstr("inside out"));
  EXPECT_THAT(one.state().mesh_doubts[0].line(), testing::HasSubstr("turned over"));
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

/// Neither what the viewer kept of it turned over nor what was kept of it as it lies there is lost.
TEST_F(MeshViewingTest, WhatIsSelectedOfAMeshThatIsInsideOutIsFoundInItsFile) {
  Mesh turned = *tablet_;
  turn_over(&turned);
  ASSERT_TRUE(write_mesh(mesh_, turned));
  const fs::path file = selections_file_of(mesh_);
  Viewer(mesh_).keep("A");
  const Result<Mesh> as_it_lies = read_mesh(mesh_);
  const Result<MeshSelection> found = kept_selection(file, *as_it_lies, "A");
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(count_of(found->ranges), 3U);
  fs::remove(file);
  ASSERT_TRUE(keep_selections(file, "tablet.ply", *as_it_lies, {{"B", MeshElement::kFace, {{4, 2}}}}));
  Viewer viewer(mesh_);
  EXPECT_THAT(*viewer.state().selections, SizeIs(1));
  viewer.keep("A");
  EXPECT_THAT(*kept_selections(file, *as_it_lies), SizeIs(2)) << "none is put aside";
}

TEST_F(MeshViewingTest, ASelectionIsKeptBesideAnotherOfItsName) {
  MeshViewing viewing([] {});
  viewing.open(mesh_);
  settle(viewing);
  for (const std::uint32_t first : {0U, 10U, 10U, 20U}) {
    viewing.keep_selection({"A", MeshElement::kFace, {{first, 3}}});
    settle(viewing);
  }
  const std::vector<MeshSelection> kept = *viewing.state().selections;
  ASSERT_THAT(kept, SizeIs(3)) << "the same is not kept twice";
  EXPECT_EQ(kept[0], (MeshSelection{"A", MeshElement::kFace, {{0, 3}}}));
  EXPECT_EQ(kept[1], (MeshSelection{"A 2", MeshElement::kFace, {{10, 3}}}));
  EXPECT_EQ(kept[2], (MeshSelection{"A 3", MeshElement::kFace, {{20, 3}}}));
  EXPECT_EQ(*kept_selections(selections_file_of(mesh_), *tablet_), kept);
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
