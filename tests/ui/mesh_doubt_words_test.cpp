// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the viewer says of a mesh's unit and of wedges that are not its own, in both languages.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/units.h"
#include "formats/mesh_io.h"
#include "station/mesh_to_view.h"
#include "station/mesh_unit_doubt.h"
#include "station/wedges_on_mesh.h"
#include "tests/support/temporary_folder.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A tent of this width as another program writes it, which says no unit.
Error doubt_of_width(const char* width, const char* height) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.obj";
  std::ofstream(file) << "v 0 0 0\nv " << width << " 0 0\nv 0 " << width << " 0\nv 0 0 " << height
                      << "\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";
  return unit_doubt(*read_mesh(file), file, "a.obj").value_or(Error{});
}

TEST(MeshDoubtWords, EveryUnitHasItsSentence) {
  const Error doubt = doubt_of_width("3", "1");
  EXPECT_EQ(translated(doubt, Language::kEnglish),
            "a.obj: as it stands it is 4.36 mm large, perhaps its numbers are cm, in; export it again in "
            "millimetres, not in cm");
  EXPECT_EQ(translated(doubt, Language::kGerman),
            "a.obj: so, wie es dasteht, ist es 4,36 mm groß, vielleicht sind seine Zahlen in cm, in; noch "
            "einmal in Millimetern ausgeben, nicht in cm");
  EXPECT_THAT(translated(doubt_of_width(".03", ".01"), Language::kEnglish),
              HasSubstr("perhaps its numbers are m; export it again in millimetres, not in m"));
  EXPECT_THAT(translated(doubt_of_width("30000", "1"), Language::kGerman), HasSubstr("nicht in um"));
  for (const std::string_view unit : kLengthUnits) {
    const Error taken = unit_taken(std::string(unit), doubt);
    EXPECT_THAT(taken.mend, HasSubstr("dubsar mesh convert --unit " + std::string(unit) + " m"));
    for (const Language language : {Language::kEnglish, Language::kGerman}) {
      const std::string shown = translated(taken, language);
      for (const char* of_commands : {"?unit", "--", "dubsar", "convert"}) {
        EXPECT_THAT(shown, Not(HasSubstr(of_commands)));
      }
    }
    const std::string german = translated(taken, Language::kGerman);
    EXPECT_THAT(german, HasSubstr("a.obj: seine Zahlen gelten als " + std::string(unit) +
                                  ", nur nach seiner Größe: so, wie es dasteht, ist es 4,36 mm groß, "));
    EXPECT_THAT(german, HasSubstr(unit == "mm" ? "; noch einmal mit Millimetern als seiner Einheit ausgeben"
                                               : "; noch einmal in Millimetern ausgeben, nicht in " +
                                                     std::string(unit)));
    EXPECT_THAT(translated(taken, Language::kEnglish),
                HasSubstr(unit == "mm" ? "; export it again with millimetres as its unit"
                                       : "; export it again in millimetres, not in " + std::string(unit)));
  }
}

TEST(MeshDoubtWords, WhatIsNotMeasuredOrNotShownIsGerman) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.obj";
  std::ofstream(file) << "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";
  const MeshToView asked = read_mesh_to_view(file, {}).value();
  ASSERT_TRUE(asked.unmeasured);
  EXPECT_EQ(translated(*asked.unmeasured, Language::kGerman),
            "a.obj: seine Keile werden erst gemessen, wenn gesagt ist, was seine Zahlen sind; noch einmal in "
            "Millimetern ausgeben, nicht in cm");
  Wedge far;
  far.depth_point_mm = {50, 0, 0};
  far.depth_mm = 1;
  const std::optional<Error> foreign = of_another_mesh({far}, asked.mesh, "a.wedges.json");
  ASSERT_TRUE(foreign);
  EXPECT_EQ(
      translated(*foreign, Language::kGerman),
      "a.wedges.json: diese Keile werden nicht gezeigt: nur 0 % davon liegen auf diesem Netz, sie gehören "
      "also zu einem anderen, oder es wurde seither verschoben oder hat eine andere Einheit; sie auf "
      "diesem Netz messen");
}

}  // namespace
}  // namespace dubsar::ui
