// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is part of another wedge, and what is not because that is none.

#include "analysis/wedge_fragments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/analysis/support/pits.h"

namespace dubsar {
namespace {

/// Positions of vertices, and wedges that lie on some of them.
class WedgeFragments : public ::testing::Test {
 protected:
  /// A good wedge of this pit, with a vertex on its faces every 0.05 mm.
  WedgeCandidate candidate(const pits::Pit& pit) {
    WedgeCandidate c;
    Wedge& w = c.wedge;
    w.depth_point_mm = pit.tip;
    w.exit_points_surface_mm = w.exit_points_mm = pit.exits;
    w.surface_normal = Eigen::Vector3d::UnitZ();
    w.depth_mm = c.floor_mm = c.nearest_mm = -pit.tip.z();
    w.intact = c.explained = c.level_rim = 1;
    c.coverage = {1, 1, 1};
    w.opening_angles_rad = {rad_from_deg(90), rad_from_deg(80), rad_from_deg(80)};
    w.face_angles_rad = {rad_from_deg(70), rad_from_deg(80), rad_from_deg(70)};
    w.edge_slopes_rad = {rad_from_deg(15), rad_from_deg(45), rad_from_deg(45)};
    for (std::size_t k = 0; k < 3; ++k) {
      w.face_normals[k] = pit.normal(k);
    }
    for (double x = -3; x < 3; x += 0.05) {
      for (double y = -3; y < 3; y += 0.05) {
        if (const double z = pit.floor(x, y); z < -0.02) {
          c.vertices.push_back(static_cast<std::uint32_t>(position_.size()));
          position_.push_back(Eigen::Vector3d(x, y, z).cast<float>());
        }
      }
    }
    w.vertex_count = static_cast<int>(c.vertices.size());
    c.area_mm2 = c.hollow_mm2 = 0.0025 * w.vertex_count;
    return c;
  }
  /// The same pit, smaller, about its depth point.
  static pits::Pit smaller(const pits::Pit& pit, double times) {
    pits::Pit out = pit;
    out.tip.z() *= times;
    for (Eigen::Vector3d& exit : out.exits) {
      exit.head<2>() = pit.tip.head<2>() + times * (exit - pit.tip).head<2>();
    }
    return out;
  }
  std::vector<std::string> judged(std::vector<WedgeCandidate> candidates) {
    judge_wholes({}, position_, &candidates);
    std::vector<std::string> out;
    for (const WedgeCandidate& c : candidates) {
      out.push_back(c.rejected);
    }
    return out;
  }

  std::vector<Eigen::Vector3f> position_;
};

TEST_F(WedgeFragments, LieInAWedgeAndNotInWhatIsJudgedToBeNone) {
  const pits::Pit pit;
  const WedgeCandidate small = candidate(smaller(pit, 0.6));
  WedgeCandidate hollow = candidate(pit);
  hollow.rms_mm = 0.1;  // rough: what is less than 0.25 mm off counts as its own
  WedgeCandidate bowl = hollow;
  bowl.wedge.roundness = 0.8;
  const std::string part = "part of another wedge";
  const std::string round = "it is round: a bowl or a cone, not three faces";
  EXPECT_THAT(judged({small, hollow}), ::testing::ElementsAre(part, "")) << "else nothing is shown here";
  EXPECT_THAT(judged({small, bowl}), ::testing::ElementsAre("", round));
  EXPECT_THAT(judged({bowl, small}), ::testing::ElementsAre(round, ""));
  // It is part of a wedge all the same where there is one.
  EXPECT_THAT(judged({small, bowl, hollow}), ::testing::ElementsAre(part, round, ""));
  // What is given back is judged as any other.
  WedgeCandidate broken = small;
  broken.coverage = {0, 0, 0};
  broken.wedge.intact = broken.explained = 0;
  broken.rms_mm = 0.1;
  EXPECT_THAT(judged({broken, bowl}), ::testing::ElementsAre("confidence too low", round));
}

TEST_F(WedgeFragments, OfAPieceGoWithTheWhole) {
  const pits::Pit pit;
  const WedgeCandidate smallest = candidate(smaller(pit, 0.45));
  const WedgeCandidate small = candidate(smaller(pit, 0.6));
  WedgeCandidate hollow = candidate(pit);
  hollow.rms_mm = 0.1;
  WedgeCandidate bowl = hollow;
  bowl.wedge.roundness = 0.8;
  WedgeCandidate middle = small;
  middle.rms_mm = 0.1;
  const std::string part = "part of another wedge";
  EXPECT_THAT(judged({smallest, middle, hollow}), ::testing::ElementsAre(part, part, ""));
  EXPECT_THAT(judged({smallest, middle, bowl}),
              ::testing::ElementsAre(part, "", ::testing::StartsWith("it is")))
      << "the middle one holds the smallest";
}

}  // namespace
}  // namespace dubsar
