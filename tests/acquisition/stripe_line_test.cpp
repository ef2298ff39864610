// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stripe_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"

namespace dubsar {
namespace {

template <class Middle>
StripeLine line_of(int count, double noise_px, const Middle& middle) {
  Random random(11);
  StripeLine line;
  for (int u = 0; u < count; ++u) {
    line.at_px.push_back(static_cast<float>(middle(u) + noise_px * random.normal()));
    line.mass.push_back(static_cast<float>(1 + random.uniform()));
  }
  return line;
}

std::vector<float> averaged(const StripeLine& line, double width_px, double largest_step_px) {
  std::vector<float> out(line.at_px.size());
  average_along(line, width_px, largest_step_px, out);
  return out;
}

TEST(StripeLine, TellsItsNoiseFromTheSurface) {
  const auto surface = [](int u) { return 300 + 40 * std::sin(u / 120.0); };
  for (const double noise : {0.02, 0.2}) {
    EXPECT_NEAR(line_noise_px(line_of(2000, noise, surface)), noise, 0.12 * noise);
  }
  // Edges and gaps are not noise.
  StripeLine broken = line_of(2000, 0.05, [](int u) { return u / 40 % 2 == 0 ? 100.0 : 130.0; });
  for (std::size_t u = 0; u < broken.at_px.size(); u += 7) {
    broken.at_px[u] = StripeLine::kNone;
  }
  EXPECT_NEAR(line_noise_px(broken), 0.05, 0.015);
}

TEST(StripeLine, NoiseThatNeighboursShareIsSeenAsWell) {
  StripeLine line = line_of(2000, 0, [](int) { return 100.0; });
  Random random(5);
  float shared = 0;
  for (std::size_t u = 0; u < line.at_px.size(); ++u) {
    shared = u % 2 == 0 ? static_cast<float>(0.2 * random.normal()) : shared;
    line.at_px[u] += shared;
  }
  EXPECT_GT(line_noise_px(line), 0.17);
}

TEST(StripeLine, TooFewColumnsTellNothing) {
  EXPECT_EQ(line_noise_px(line_of(20, 0.3, [](int) { return 50.0; })), 0.0);
  EXPECT_EQ(line_noise_px({}), 0.0);
}

TEST(StripeLine, TheNoisierTheWiderTheAverage) {
  EXPECT_LT(averaging_width_px(0.0), 0.4);
  EXPECT_LT(averaging_width_px(0.02), 0.5);
  EXPECT_GT(averaging_width_px(0.2), 1.0);
  EXPECT_LE(averaging_width_px(5), 2.5);
}

TEST(StripeLine, ASlopeStaysWhatItIsWhereverTheLightIs) {
  const auto slope = [](int u) { return 100 + 0.7 * u; };
  const StripeLine line = line_of(60, 0, slope);
  const std::vector<float> out = averaged(line, 2, 3);
  for (int u = 0; u < 60; ++u) {
    EXPECT_NEAR(static_cast<double>(out[static_cast<std::size_t>(u)]), slope(u), 1e-4) << u;
  }
}

TEST(StripeLine, NothingIsAveragedOverAnEdgeOrAGap) {
  StripeLine line = line_of(60, 0, [](int u) { return u < 30 ? 100.0 : 108.0; });
  line.at_px[45] = StripeLine::kNone;
  line.at_px[46] = 140.0F;  // alone between a gap and an edge
  const std::vector<float> out = averaged(line, 2.5, 2);
  for (std::size_t u = 0; u < 60; ++u) {
    if (u == 45) {
      EXPECT_TRUE(std::isnan(out[u]));
    } else {
      EXPECT_NEAR(out[u], line.at_px[u], 1e-4) << u;
    }
  }
}

TEST(StripeLine, AveragesTheNoiseAway) {
  const StripeLine line = line_of(4000, 0.2, [](int) { return 100.0; });
  const std::vector<float> out = averaged(line, 2, 5);
  double squares = 0;
  for (const float at : out) {
    squares += (at - 100.0) * (at - 100.0);
  }
  // A Gaussian of that width leaves 1/√(2 √π · 2) = 0.38 of it; unequal light a little more.
  EXPECT_LT(std::sqrt(squares / 4000), 0.2 * 0.45);
}

}  // namespace
}  // namespace dubsar
