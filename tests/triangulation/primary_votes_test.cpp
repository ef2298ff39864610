// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/primary_votes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace dubsar {
namespace {

constexpr int kNodes = 40;  ///< along each side

/// Two scans whose samples lie on each other, node for node.
struct TwoAlike {
  StitchSurface surfaces[2];
  Pairs pairs[2];

  TwoAlike() {
    for (int k = 0; k < 2; ++k) {
      StitchSurface& s = surfaces[k];
      s.lattice = Lattice(kNodes * Lattice::kNodeSide, kNodes * Lattice::kNodeSide);
      s.usable.assign(static_cast<std::size_t>(s.lattice.rows) * static_cast<std::size_t>(s.lattice.cols),
                      kUsable);
      s.score.assign(s.lattice.size(), 1.0F);
      for (std::size_t node = 0; node < s.lattice.size(); ++node) {
        s.node_sample.push_back(s.lattice.row_of(node) * Lattice::kNodeSide * s.lattice.cols +
                                s.lattice.col_of(node) * Lattice::kNodeSide);
      }
      pairs[k].match = s.node_sample;
    }
  }
  [[nodiscard]] std::vector<std::vector<float>> votes() const {
    std::vector<OwnedScan> scans(2);
    for (std::size_t k = 0; k < 2; ++k) {
      scans[k].surface = &surfaces[k];
      scans[k].pairs = {&pairs[k]};
      scans[k].other = {1 - k};
    }
    return primary_votes(scans);
  }
};

/// Borders between nodes beside each other that the first scan has and has not.
int borders(const std::vector<float>& votes) {
  int count = 0;
  for (std::size_t row = 0; row < kNodes; ++row) {
    for (std::size_t col = 0; col < kNodes; ++col) {
      const float here = votes[row * kNodes + col];
      count += col + 1 < kNodes && votes[row * kNodes + col + 1] != here ? 1 : 0;
      count += row + 1 < kNodes && votes[(row + 1) * kNodes + col] != here ? 1 : 0;
    }
  }
  return count;
}

TEST(PrimaryVotes, OfTwoScansThatSeeAPlaceAlikeNoiseDoesNotDecideNodeByNode) {
  TwoAlike two;
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0F, 0.02F);
  for (std::size_t node = 0; node < two.surfaces[0].score.size(); ++node) {
    const auto col = static_cast<float>(two.surfaces[0].lattice.col_of(node));
    two.surfaces[0].score[node] = 1.0F + 0.002F * (20.0F - col) + noise(random);
    two.surfaces[1].score[node] = 1.0F + noise(random);
  }
  const auto votes = two.votes();
  EXPECT_LE(borders(votes[0]), 2 * kNodes);  // by the score alone over a thousand
  EXPECT_EQ(votes[0][20 * kNodes + 2], 1.0F);
  EXPECT_EQ(votes[0][20 * kNodes + 37], -1.0F);
  for (std::size_t node = 0; node < votes[0].size(); ++node) {
    ASSERT_EQ(votes[0][node], -votes[1][node]);  // each place has one of them
  }
}

TEST(PrimaryVotes, AFlankThatAnotherScanSeesMuchBetterIsThatOnes) {
  TwoAlike two;
  for (std::size_t row = 15; row < 21; ++row) {
    for (std::size_t col = 15; col < 25; ++col) {
      two.surfaces[0].score[row * kNodes + col] = 0.5F;
    }
  }
  const auto votes = two.votes();
  for (std::size_t row = 15; row < 21; ++row) {
    for (std::size_t col = 15; col < 25; ++col) {
      EXPECT_EQ(votes[1][row * kNodes + col], 1.0F) << row << ' ' << col;
    }
  }
  EXPECT_EQ(std::ranges::count(votes[1], 1.0F), 60);
}

TEST(PrimaryVotes, WantedAreTheSamplesAroundTheNodesThatAreItsOwn) {
  TwoAlike two;
  for (std::size_t row = 10; row < 20; ++row) {
    std::fill_n(two.surfaces[1].score.begin() + static_cast<std::ptrdiff_t>(row * kNodes + 10), 10, 3.0F);
  }
  const auto votes = two.votes();
  const std::vector<std::uint8_t> wanted = wanted_samples(two.surfaces[1], votes[1], 100);
  EXPECT_EQ(wanted[42 * kNodes * Lattice::kNodeSide + 42], 1);
  EXPECT_EQ(wanted[30 * kNodes * Lattice::kNodeSide + 60], 0);
  const auto count = std::ranges::count(wanted, std::uint8_t{1});
  EXPECT_NEAR(static_cast<double>(count), 1600, 60);
  EXPECT_EQ(std::ranges::count(wanted_samples(two.surfaces[1], votes[1], 1700), std::uint8_t{1}), 0);
}

}  // namespace
}  // namespace dubsar
