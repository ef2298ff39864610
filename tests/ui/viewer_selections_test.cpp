// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Selections and corrections of the viewer, from the click to the files, through the real window.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include "formats/mesh_io.h"
#include "formats/wedges_json.h"
#include "station/selection_store.h"
#include "tests/ui/support/on_a_tablet.h"

namespace dubsar {
namespace {

using test::run_command;

constexpr const char* kSelect = R"(wait wedges 60
wait whole
wait idle
click tool-select
click surface 0.35 0.35
click surface 0.65 0.35
click surface 0.65 0.6
click surface 0.35 0.6
click surface 0.35 0.35
wait selected
click selection-name
type line 3
click name-selection
wait kept.1
wait idle
click keep-selection
pause 0.2
wait idle
click selected-wedges
pause 0.2
wait idle
click clear-selection
click kept.1
wait selected
click select-points
click surface 0.4 0.4
click surface 0.5 0.4
click surface 0.45 0.5
click surface 0.4 0.4
wait selected
click selection-name
key selectall
type corner
click name-selection
wait kept.2
wait idle
click kept.1
wait whole
click analyse-part
wait part 60
wait idle 60
click whole-mesh
wait kept.2
quit
)";

constexpr const char* kCorrect = R"(wait wedges 60
wait whole
wait idle
click tool-correct
click wedge.3
wait marked.1
click wedge-delete
wait corrections.1 60
wait idle
wheel surface 8
click tool-select
click surface 0.36 0.3
click surface 0.64 0.3
click surface 0.64 0.7
click surface 0.36 0.7
click surface 0.36 0.3
wait selected
click tool-correct
click wedge-add
wait corrections.2 60
wait idle
wait whole
screenshot corrected.png
click wedge.4
click wedge.5
wait marked.2
click wedge-merge
wait not-made
expect corrections.2
quit
)";

constexpr const char* kTakeBack = R"(wait wedges 60
wait idle
click tool-correct
wait corrections.2
click wedge-undo
wait corrections.1 60
quit
)";

using ViewerCorrections = test::OnATablet;

TEST_F(ViewerCorrections, AreMadeKeptAndTakenBack) {
  const auto before = read_wedges(in("tablet.wedges.json"));
  ASSERT_TRUE(before);
  auto outcome = play(kCorrect);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto after = read_wedges(in("tablet.wedges.json"));
  ASSERT_TRUE(after);
  EXPECT_EQ(after->corrections, 2U);
  ASSERT_EQ(after->wedges.size(), before->wedges.size());
  const Wedge& added = after->wedges.back();
  EXPECT_EQ(added.by_hand, ByHand::kAdded);
  EXPECT_EQ(added.id, static_cast<int>(before->wedges.size()));
  EXPECT_LT((added.depth_point_mm - before->wedges[3].depth_point_mm).norm(), 0.1);
  EXPECT_EQ(after->wedges[3].id, 4);
  // The command makes the same of it.
  ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", in("again.json"), "--corrections",
                         in("tablet.wedges.corrections.json")})
                .status,
            0);
  EXPECT_EQ(read_wedges(in("again.json"))->wedges.back().depth_point_mm, added.depth_point_mm);
  // In another window they are known, and can be taken back.
  outcome = play(kTakeBack);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_wedges(in("tablet.wedges.json"))->wedges.size(), before->wedges.size() - 1);
}

using ViewerSelections = test::OnATablet;

TEST_F(ViewerSelections, AreNamedKeptWrittenAndAnalysedAlone) {
  const auto outcome = play(kSelect);
  ASSERT_EQ(outcome.status, 0) << outcome.err;

  const auto mesh = read_mesh(in("tablet.ply"));
  ASSERT_TRUE(mesh);
  const auto kept = kept_selections(in("tablet.selections.json"), *mesh);
  ASSERT_TRUE(kept) << kept.error().line();
  ASSERT_EQ(kept->size(), 2U);
  EXPECT_EQ((*kept)[0].name, "line 3");
  EXPECT_EQ((*kept)[0].of, MeshElement::kFace);
  EXPECT_EQ((*kept)[1].name, "corner");
  EXPECT_EQ((*kept)[1].of, MeshElement::kVertex);

  // The part that was written is the part that was selected, by the window and by the command.
  const Mesh wanted = part_of(*mesh, kept->front());
  const auto part = read_mesh(in("tablet_part_01.ply"));
  ASSERT_TRUE(part);
  EXPECT_EQ(part->positions, wanted.positions);
  EXPECT_EQ(part->faces, wanted.faces);
  EXPECT_GT(part->faces.size(), 500U);
  EXPECT_LT(part->faces.size(), mesh->faces.size() / 4);
  ASSERT_EQ(
      run_command({"mesh", "part", in("tablet.ply"), "--selection", "line 3", "-o", in("again.ply")}).status,
      0);
  const auto bytes = [](const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytes(in("again.ply")), bytes(in("tablet_part_01.ply")));
  ASSERT_EQ(run_command({"mesh", "part", in("tablet.ply"), "--selection", "line 3", "--wedges",
                         in("tablet.wedges.json"), "-o", in("again.csv")})
                .status,
            0);
  EXPECT_EQ(bytes(in("again.csv")), bytes(in("tablet_wedges_01.csv")));
  EXPECT_EQ(run_command({"mesh", "part", in("tablet.ply"), "--selection", "x", "-o", in("no.ply")}).status,
            2);

  // Analysed alone it is what the command makes of the part.
  const auto alone = read_wedges(in("tablet_part_02.wedges.json"));
  ASSERT_TRUE(alone);
  ASSERT_EQ(run_command({"analyze", in("tablet_part_02.ply"), "-o", in("part.json")}).status, 0);
  const auto by_command = read_wedges(in("part.json"));
  ASSERT_TRUE(by_command);
  EXPECT_GT(alone->wedges.size(), 2U);
  ASSERT_EQ(alone->wedges.size(), by_command->wedges.size());
  for (std::size_t k = 0; k < alone->wedges.size(); ++k) {
    EXPECT_EQ(alone->wedges[k].depth_point_mm, by_command->wedges[k].depth_point_mm);
  }
}

/// A wedge is chosen and marked, then clay that has none is looked at alone.
constexpr const char* kBareClay = R"(wait wedges 60
wait whole
wait idle
click tool-correct
click wedge.5
wait marked.1
expect chosen.5
key 6
wait looks-at.bottom
wait whole
click tool-select
click surface 0.46 0.46
click surface 0.54 0.46
click surface 0.54 0.54
click surface 0.46 0.54
click surface 0.46 0.46
wait selected
click tool-correct
expect marked.1
click tool-select
click analyse-part
wait part 60
wait idle 60
expect chosen.none
click tool-correct
wait marked.0
click tool-turn
click whole-mesh
wait whole
wait idle
expect chosen.none
quit
)";

TEST_F(ViewerSelections, WhatIsChosenGoesWithTheListThatItIsOf) {
  const auto outcome = play(kBareClay);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto alone = read_wedges(in("tablet_part_01.wedges.json"));
  ASSERT_TRUE(alone) << alone.error().line();
  EXPECT_EQ(alone->wedges.size(), 0U);
}

constexpr const char* kAlgebra = R"(wait wedges 60
wait whole
wait idle
click tool-select
click surface 0.3 0.35
click surface 0.6 0.35
click surface 0.6 0.6
click surface 0.3 0.6
click surface 0.3 0.35
wait selected
click selection-name
type a
click name-selection
wait kept.1
click clear-selection
{b}
wait selected
click selection-name
key selectall
type b
click name-selection
wait kept.2
click kept.1
wait selected
click select-intersect
{b}
wait selected
click selection-name
key selectall
type both
click name-selection
wait kept.3
click kept.1
wait selected
click select-subtract
{b}
wait selected
click selection-name
key selectall
type without
click name-selection
wait kept.4
click kept.1
wait selected
click select-union
{b}
wait selected
click selection-name
key selectall
type either
click name-selection
wait kept.5
quit
)";
constexpr const char* kPolygonB =
    "click surface 0.5 0.45\nclick surface 0.75 0.45\nclick surface 0.75 0.7\nclick surface 0.5 0.7\n"
    "click surface 0.5 0.45\nwait whole";

TEST_F(ViewerSelections, PolygonsAreAddedCutAndTakenAway) {
  std::string script = kAlgebra;
  for (std::size_t at = script.find("{b}"); at != std::string::npos; at = script.find("{b}")) {
    script.replace(at, 3, kPolygonB);
  }
  const auto outcome = play(script);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto mesh = read_mesh(in("tablet.ply"));
  ASSERT_TRUE(mesh);
  const auto kept = kept_selections(in("tablet.selections.json"), *mesh);
  ASSERT_TRUE(kept) << kept.error().line();
  std::map<std::string, std::vector<std::uint32_t>> faces;
  for (const MeshSelection& selection : *kept) {
    faces[selection.name] = indices_of(selection.ranges);
  }
  ASSERT_EQ(faces.size(), 5U);
  std::vector<std::uint32_t> wanted;
  std::ranges::set_intersection(faces["a"], faces["b"], std::back_inserter(wanted));
  EXPECT_GT(wanted.size(), 50U);
  EXPECT_EQ(faces["both"], wanted);
  wanted.clear();
  std::ranges::set_difference(faces["a"], faces["b"], std::back_inserter(wanted));
  EXPECT_EQ(faces["without"], wanted);
  wanted.clear();
  std::ranges::set_union(faces["a"], faces["b"], std::back_inserter(wanted));
  EXPECT_EQ(faces["either"], wanted);
}

/// Also where only one of the files of a number is there already.
TEST_F(ViewerSelections, NothingThatIsThereIsWrittenOver) {
  const std::map<std::string, std::string> there{{in("tablet_section_01.svg"), "a drawing"},
                                                 {in("tablet_part_01.wedges.json"), "wedges"},
                                                 {in("tablet_part_02.selections.json"), "selections"}};
  for (const auto& [file, text] : there) {
    std::ofstream(file) << text;
  }
  const auto outcome = play(R"(wait wedges 60
wait whole
wait idle
click tool-section
click surface 0.4 0.5
click surface 0.6 0.5
wait section
click keep-section
wait section-kept
wait idle
click tool-select
click surface 0.46 0.46
click surface 0.54 0.46
click surface 0.54 0.54
click surface 0.46 0.54
click surface 0.46 0.46
wait selected
expect whole.clear-selection
click analyse-part
wait part 60
wait idle 60
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const auto& [file, text] : there) {
    EXPECT_EQ(test::bytes_of(file), text) << file;
  }
  for (const char* name : {"tablet_section_02.csv", "tablet_section_02.svg", "tablet_part_03.ply",
                           "tablet_part_03.wedges.json"}) {
    EXPECT_TRUE(std::filesystem::exists(in(name))) << name;
  }
}

/// In the language with the longer words, also in a narrow window: beside the number where it fits, else
/// below.
TEST_F(ViewerSelections, TheButtonThatClearsThemIsNotCutOff) {
  std::ofstream(in("wide.script")) << "wait wedges 60\nwait whole\nwait idle\nclick tool-select\n"
                                      "click surface 0.1 0.1\nclick surface 0.9 0.1\nclick surface 0.9 0.9\n"
                                      "click surface 0.1 0.9\nclick surface 0.1 0.1\nwait selected\n"
                                      "expect whole.clear-selection\nquit\n";
  for (const char* width : {"1366", "1000"}) {
    const auto outcome = run_command({"view", in("tablet.ply"), "--script", in("wide.script"), "--language",
                                      "de", "--width", width, "--height", "768"});
    EXPECT_EQ(outcome.status, 0) << width << ": " << outcome.err;
  }
}

}  // namespace
}  // namespace dubsar
