// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A mesh whose unit nobody said, and wedges beside a mesh that are not its own: what the viewer says and
// does.

#include <gmock/gmock.h>

#include "core/inside_out.h"
#include "formats/atomic_file.h"
#include "formats/wedges_json.h"
#include "station/done_stamp.h"
#include "tests/station/support/viewed_tablet.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

using test::settle;
using test::Viewer;

std::string without_unit(std::string ply) {
  for (std::size_t at; (at = ply.find("obj_info")) != std::string::npos;) {
    ply.erase(at, ply.find('\n', at) + 1 - at);
  }
  return ply;
}

class MeshDoubts : public test::OnAViewedTablet {
 protected:
  [[nodiscard]] static Mesh scaled(double factor) {
    Mesh out = *tablet_;  // 20 mm across
    for (Eigen::Vector3f& p : out.positions) {
      p *= static_cast<float>(factor);
    }
    return out;
  }
  /// As another program writes it.
  void write_numbers(double factor) const {
    ASSERT_TRUE(write_mesh(mesh_, scaled(factor)));
    ASSERT_TRUE(write_file_atomically(mesh_, without_unit(*read_whole_file(mesh_))));
  }
  /// Those of the tablet, in millimetres.
  void write_wedges_beside(const std::string& unit_assumed) const {
    ASSERT_TRUE(write_wedges(wedges_file_, wedges_of_tablet(unit_assumed)));
  }
  [[nodiscard]] static WedgeFile wedges_of_tablet(const std::string& unit_assumed) {
    JobContext job;
    WedgeFile file = wedge_file("tablet.ply", {}, *analyze_mesh(*tablet_, {}, job));
    file.unit_assumed = unit_assumed;
    return file;
  }
  [[nodiscard]] static std::vector<std::string> lines_of(const std::vector<Error>& doubts) {
    std::vector<std::string> out;
    for (const Error& doubt : doubts) {
      out.push_back(doubt.line());
    }
    return out;
  }
  [[nodiscard]] static double across_mm(const ViewedMesh& state) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : state.mesh->positions) {
      box.extend(p);
    }
    return static_cast<double>(box.diagonal().norm());
  }
  [[nodiscard]] static MeshSelection all() {
    return {"all", MeshElement::kFace, {{0, static_cast<std::uint32_t>(tablet_->faces.size())}}};
  }

  fs::path wedges_file_ = folder_.path() / "mesh" / "tablet.wedges.json";
};

TEST_F(MeshDoubts, TheDoubtOfAUnitStaysWhateverIsDoneWithTheMesh) {
  write_numbers(0.001);
  MeshViewing viewing([] {});
  const auto doubts = [&] {
    settle(viewing);
    return lines_of(viewing.state().mesh_doubts);
  };
  viewing.open(mesh_);
  const auto taken = ElementsAre(AllOf(HasSubstr("its numbers are taken for m, by its size alone"),
                                       HasSubstr("dubsar mesh convert --unit m makes")));
  ASSERT_THAT(doubts(), taken);
  EXPECT_NEAR(across_mm(viewing.state()), 20, 3) << "as analyze takes it";
  viewing.keep_selection(all());
  EXPECT_THAT(doubts(), taken);
  EXPECT_THAT(viewing.state().written, SizeIs(1));
  viewing.cut({-4, 0, 4}, {4, 0, 4}, Eigen::Vector3d::UnitZ());
  settle(viewing);
  viewing.keep_section(folder_.path() / "cut");
  EXPECT_THAT(doubts(), taken);
  EXPECT_THAT(*read_whole_file(folder_.path() / "cut.svg"), HasSubstr("Unit: its numbers are taken for m"));
  viewing.cut({0, 0, 4}, {0, 0, 5}, Eigen::Vector3d::UnitZ());
  EXPECT_THAT(doubts(), taken);
  viewing.write_part(all(), folder_.path() / "part.ply");
  EXPECT_THAT(doubts(), taken);
  EXPECT_THAT(*read_whole_file(folder_.path() / "part.ply"),
              HasSubstr("comment Unit: its numbers are taken for m"));
  viewing.analyse_part(all(), folder_.path() / "alone");
  EXPECT_THAT(doubts(), taken) << "of the part";
  ASSERT_TRUE(viewing.state().wedges) << viewing.state().error->line();
  EXPECT_THAT(*read_whole_file(folder_.path() / "alone.wedges.json"),
              HasSubstr("\"Unit\": \"its numbers are taken for m"));
  viewing.leave_part();
  EXPECT_THAT(doubts(), taken);
  EXPECT_FALSE(viewing.state().error);
  ASSERT_TRUE(write_mesh(mesh_, *tablet_));
  viewing.open(mesh_);
  EXPECT_THAT(doubts(), IsEmpty()) << "of another mesh";
}

TEST_F(MeshDoubts, NothingIsMeasuredWhereAnalyzeAsksForTheUnit) {
  write_numbers(0.1);  // centimetres or inches: who knows
  MeshViewing viewing([] {});
  viewing.open(mesh_);
  settle(viewing);
  const auto doubted = ElementsAre(HasSubstr("as it stands it is 1.99 mm large, perhaps its numbers are"));
  EXPECT_THAT(lines_of(viewing.state().mesh_doubts), doubted);
  const auto expect_refused = [&](const char* what) {
    settle(viewing);
    ASSERT_TRUE(viewing.state().error) << what;
    EXPECT_THAT(viewing.state().error->line(),
                AllOf(HasSubstr("not measured before it is said what its numbers are"),
                      HasSubstr("dubsar mesh convert --unit cm makes")))
        << what;
    EXPECT_FALSE(viewing.state().wedges) << what;
    EXPECT_THAT(lines_of(viewing.state().mesh_doubts), doubted) << what;
  };
  viewing.analyse();
  expect_refused("all of it");
  viewing.analyse_part(all(), folder_.path() / "alone");
  expect_refused("a part");
  EXPECT_FALSE(fs::exists(folder_.path() / "alone.ply"));
  viewing.correct_by_adding(all());
  expect_refused("a wedge by hand");
  viewing.write_part(all(), folder_.path() / "part.ply");
  settle(viewing);
  const std::string part = *read_whole_file(folder_.path() / "part.ply");
  EXPECT_THAT(part, Not(HasSubstr("obj_info unit"))) << "nobody said it";
  EXPECT_THAT(part, HasSubstr("comment Unit: as it stands it is"));
  EXPECT_EQ(read_mesh(folder_.path() / "part.ply")->faces.size(), tablet_->faces.size());
}

TEST_F(MeshDoubts, AMeshIsReadInTheUnitThatItsWedgesWereMeasuredIn) {
  write_numbers(0.001);
  write_wedges_beside("m");
  Viewer assumed(mesh_);
  ASSERT_TRUE(assumed.state().wedges);
  EXPECT_NEAR(across_mm(assumed.state()), 20, 3);
  EXPECT_THAT(lines_of(assumed.state().mesh_doubts), ElementsAre(HasSubstr("are taken for m")));
  assumed.remove_wedge(wedges_mm_[0]);
  ASSERT_FALSE(assumed.state().error) << assumed.state().error->line();
  EXPECT_EQ(read_wedges(wedges_file_)->corrections, 1U);
  EXPECT_EQ(read_wedges(wedges_file_)->unit_assumed, "m") << "nobody has said it by now either";
  fs::remove(corrections_);
  // In centimetres somebody has said it: `dubsar analyze --unit cm`, as its stamp tells.
  write_numbers(0.1);
  write_wedges_beside("");
  DoneStamp stamp;
  stamp.verb = "analyze";
  stamp.parameters = R"({"exit": "surface", "unit": "cm", "free_openness": 0, "free_concave_per_mm": 1,
    "equalize": false, "fault_reach": 2, "uniform_weights": false, "classical_watershed": false,
    "mesh_out": "", "pictures": "", "svg": "", "invariants": ""})";
  const std::string bytes = done_stamp_to_json(stamp);
  ASSERT_TRUE(write_file_atomically(stamp_beside(wedges_file_), std::string_view(bytes)));
  Viewer said(mesh_);
  ASSERT_TRUE(said.state().wedges);
  EXPECT_NEAR(across_mm(said.state()), 20, 3);
  EXPECT_THAT(said.state().mesh_doubts, IsEmpty());
}

TEST_F(MeshDoubts, WedgesOfAnotherMeshAreNotShownAsItsOwn) {
  write_wedges_beside("");
  const auto shown_on = [this](const Mesh& mesh, const char* name) {
    const fs::path file = mesh_.parent_path() / name;
    EXPECT_TRUE(write_mesh(file, mesh));
    fs::path beside = file;
    beside.replace_extension(".wedges.json");
    EXPECT_TRUE(write_wedges(beside, wedges_of_tablet("")));
    Viewer viewer(file);
    const bool told = !viewer.state().mesh_doubts.empty() &&
                      viewer.state().mesh_doubts.back().what.starts_with("these wedges are not shown");
    EXPECT_NE(told, viewer.state().wedges != nullptr) << name;
    return !told;
  };
  EXPECT_TRUE(shown_on(*tablet_, "tablet.ply"));
  EXPECT_TRUE(shown_on(*tablet_, "renamed.obj"));
  EXPECT_TRUE(shown_on(*tablet_, "small.draco.glb"));
  Mesh noisy = *tablet_;
  for (std::size_t v = 0; v < noisy.positions.size(); ++v) {
    noisy.positions[v].z() += v % 2 == 0 ? 0.01F : -0.01F;
  }
  EXPECT_TRUE(shown_on(noisy, "stitched_anew.ply"));

  Mesh moved = *tablet_;
  for (Eigen::Vector3f& p : moved.positions) {
    p.x() += 1;
  }
  EXPECT_FALSE(shown_on(moved, "moved.ply"));
  EXPECT_FALSE(shown_on(scaled(10), "ten_times.ply"));
  sim::TabletOptions options;
  options.size_mm = {14, 11, 8};
  options.spacing_mm = 0.2;
  JobContext job;
  options.seed = 6;
  EXPECT_FALSE(shown_on(sim::make_tablet(options, job)->mesh, "another.ply"));
  options.seed = 5;
  options.text_density = 0;
  EXPECT_FALSE(shown_on(sim::make_tablet(options, job)->mesh, "blank.ply"));
}

TEST_F(MeshDoubts, WedgesOfAnotherMeshAreNotWrittenOver) {
  write_wedges_beside("");
  const std::string before = *read_whole_file(wedges_file_);
  Mesh moved = *tablet_;
  for (Eigen::Vector3f& p : moved.positions) {
    p.x() += 1;
  }
  ASSERT_TRUE(write_mesh(mesh_, moved));
  Viewer viewer(mesh_);
  EXPECT_THAT(lines_of(viewer.state().mesh_doubts),
              ElementsAre(AllOf(StartsWith("tablet.wedges.json: these wedges are not shown: only "),
                                HasSubstr("; measure them on this mesh"))));
  viewer.find_wedges();
  ASSERT_TRUE(viewer.state().wedges) << "measured on it";
  EXPECT_FALSE(viewer.state().error);
  viewer.remove_wedge(wedges_mm_[0] + Eigen::Vector3d::UnitX());
  ASSERT_TRUE(viewer.state().error);
  EXPECT_THAT(viewer.state().error->line(), HasSubstr("these wedges are not shown"));
  EXPECT_EQ(*read_whole_file(wedges_file_), before);
  EXPECT_FALSE(fs::exists(corrections_));
}

}  // namespace
}  // namespace dubsar
