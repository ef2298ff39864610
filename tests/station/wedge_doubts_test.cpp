// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "analysis/text_frame.h"
#include "analysis/wedge_features.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Of an inscribed tablet, scanned finely.
WedgeFile sound_file(std::size_t count = 12) {
  WedgeFile file;
  file.text_from_model = RigidTransform();
  file.text_certainty = kCertainText;
  file.spacing_mm = 0.1;
  file.wedges.resize(count);
  for (Wedge& wedge : file.wedges) {
    wedge.depth_mm = 0.4;
    wedge.roundness = kMostRoundness;
  }
  return file;
}

std::vector<std::string> lines(const WedgeFile& file, std::size_t bodies = 0) {
  std::vector<std::string> out;
  for (const Error& doubt : doubts_of(file, "t.ply", bodies)) {
    out.push_back(doubt.line());
  }
  return out;
}

TEST(WedgeDoubts, OfASoundFileThereAreNone) {
  EXPECT_THAT(lines(sound_file()), IsEmpty());
  EXPECT_THAT(lines(sound_file(), 1), IsEmpty());
  EXPECT_THAT(lines(sound_file(0)), IsEmpty());
}

TEST(WedgeDoubts, OfSeveralBodiesTheCountOrThePlacesTell) {
  EXPECT_THAT(lines(sound_file(), 2), ElementsAre(StartsWith("t.ply: several bodies in one mesh")));
  WedgeFile file = sound_file();
  file.wedges[3].place.body = 1;
  EXPECT_THAT(lines(file), ElementsAre(StartsWith("t.ply: several bodies in one mesh")));
}

TEST(WedgeDoubts, NoTextIsToldWhereItWasLookedFor) {
  WedgeFile file = sound_file();
  file.text_certainty = 0.99 * kCertainText;
  EXPECT_THAT(lines(file),
              ElementsAre(StartsWith("t.ply: no direction of writing shows in the 12 wedges that were found: "
                                     "confidence was learnt on inscribed tablets")));
  file.wedges.resize(1);
  EXPECT_THAT(
      lines(file),
      ElementsAre(StartsWith("t.ply: no direction of writing shows in the one wedge that was found: ")));
  file.text_from_model.reset();
  EXPECT_THAT(lines(file), IsEmpty()) << "as a truth.json, which does not say it";
}

TEST(WedgeDoubts, ACoarseMeshIsToldUnlessItsWedgesAreLarge) {
  WedgeFile file = sound_file();
  file.spacing_mm = 0.2;
  EXPECT_THAT(lines(file),
              ElementsAre("t.ply: too coarse for wedges of the usual size, many or all of them are missed: "
                          "the mesh's spacing is 0.20 mm; scan it, or export it, at 0.1 mm or finer"));
  for (Wedge& wedge : file.wedges) {
    wedge.depth_mm = 0.8;
  }
  EXPECT_THAT(lines(file), IsEmpty());
  file.wedges.clear();
  EXPECT_EQ(lines(file).size(), 1U);
  file.spacing_mm = 0;
  EXPECT_THAT(lines(file), IsEmpty()) << "a file of a version that did not say it";
}

TEST(WedgeDoubts, WornWedgesAreToldWhereTheyAreMost) {
  WedgeFile file = sound_file();
  for (std::size_t k = 0; k < 6; ++k) {
    file.wedges[k].roundness = 1.01 * kMostRoundness;
  }
  file.wedges[6].roundness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(lines(file), IsEmpty()) << "half of them";
  file.wedges[7].roundness = 0.09;
  EXPECT_THAT(lines(file),
              ElementsAre("t.ply: most of the wedges are worn (their edges are rounded: 7): depths and "
                          "angles are those of the clay as it is, not of what was pressed; leave them out "
                          "to compare hands"));
}

}  // namespace
}  // namespace dubsar
