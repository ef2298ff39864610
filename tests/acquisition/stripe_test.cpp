// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stripe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"

namespace dubsar {
namespace {

/// A stripe of a Gaussian cross section along middle(u), integrated over the pixels, on a background.
template <class Middle>
GrayImage drawn(int width, int height, double sigma, double peak, double ground, const Middle& middle) {
  GrayImage image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      double light = 0;
      for (int k = 0; k < 8; ++k) {
        const double d = v - 0.5 + (k + 0.5) / 8 - middle(u);
        light += peak / 8 * std::exp(-d * d / (2 * sigma * sigma));
      }
      image.pixels[image.index(u, v)] =
          static_cast<std::uint8_t>(std::clamp(std::round(light + ground), 0.0, 255.0));
    }
  }
  return image;
}

double slanted(int u) {
  return 60.3 + 0.11 * u;
}

class EveryMethod : public testing::TestWithParam<StripeMethod> {
 protected:
  StripeProfile run(const GrayImage& on, const GrayImage& off = {}) {
    StripeOptions options;
    options.method = GetParam();
    StripeExtractor extractor(options);
    StripeProfile profile;
    extractor.extract(on.view(), off.view(), profile);
    return profile;
  }
};

TEST_P(EveryMethod, FindsTheMiddleToAFewHundredthsOfAPixel) {
  const StripeProfile profile = run(drawn(200, 160, 1.2, 180, 4, slanted));
  double squares = 0;
  for (int u = 5; u < 195; ++u) {
    ASSERT_EQ(profile.state[static_cast<std::size_t>(u)], StripeState::kGood);
    const double error = static_cast<double>(profile.at_px[static_cast<std::size_t>(u)]) - slanted(u);
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / 190), 0.03);
}

TEST_P(EveryMethod, AmbientLightIsTakenOff) {
  // A lamp brighter than the stripe stands in the picture, with the laser on and off.
  const auto lamp = [](int) { return 20.0; };
  GrayImage off = drawn(100, 160, 3, 220, 6, lamp);
  GrayImage on = off;
  const GrayImage stripe = drawn(100, 160, 1.2, 120, 0, slanted);
  for (std::size_t i = 0; i < on.pixels.size(); ++i) {
    on.pixels[i] = static_cast<std::uint8_t>(std::min(255, on.pixels[i] + stripe.pixels[i]));
  }
  const StripeProfile blind = run(on);
  EXPECT_GT(std::abs(static_cast<double>(blind.at_px[50]) - slanted(50)), 5);
  const StripeProfile seeing = run(on, off);
  ASSERT_EQ(seeing.state[50], StripeState::kGood);
  EXPECT_NEAR(static_cast<double>(seeing.at_px[50]), slanted(50), 0.05);
}

TEST_P(EveryMethod, SaidWhyAColumnHasNoSample) {
  GrayImage image = drawn(100, 160, 1.2, 180, 4, slanted);
  const GrayImage ghost = drawn(100, 160, 1.2, 150, 0, [](int) { return 130.0; });
  const GrayImage near_ghost = drawn(100, 160, 1.2, 150, 0, [](int u) { return slanted(u) + 9; });
  const GrayImage burnt = drawn(100, 160, 6, 900, 0, slanted);
  const GrayImage smear = drawn(100, 160, 5, 150, 0, slanted);
  for (int v = 0; v < 160; ++v) {
    const auto put = [&](int u, int value) {
      image.pixels[image.index(u, v)] = static_cast<std::uint8_t>(std::min(255, value));
    };
    for (int u = 0; u < 100; ++u) {
      if (u < 10) {
        put(u, 4);
      } else if (u < 20) {
        put(u, image.at(u, v) + ghost.at(u, v));
      } else if (u < 30) {
        put(u, image.at(u, v) + near_ghost.at(u, v));
      } else if (u < 40) {
        put(u, burnt.at(u, v));
      } else if (u < 50) {
        put(u, smear.at(u, v));
      }
    }
  }
  const StripeProfile profile = run(image);
  EXPECT_EQ(profile.state[5], StripeState::kNone);
  EXPECT_EQ(profile.state[15], StripeState::kReflection);
  EXPECT_EQ(profile.state[25], StripeState::kReflection);
  EXPECT_EQ(profile.state[35], StripeState::kSaturated);
  EXPECT_EQ(profile.state[45], StripeState::kWide);
  EXPECT_EQ(profile.state[70], StripeState::kGood);
  EXPECT_EQ(profile.confidence[35], 0.0F);
  EXPECT_GT(profile.confidence[70], 0.5F);
}

TEST_P(EveryMethod, NoiseAloneGivesNoSample) {
  GrayImage image(64, 160);
  Random random(3);
  for (std::uint8_t& pixel : image.pixels) {
    pixel = static_cast<std::uint8_t>(std::clamp(std::round(5 + 2 * random.normal()), 0.0, 255.0));
  }
  EXPECT_EQ(run(image).count_of(StripeState::kGood), 0U);
}

INSTANTIATE_TEST_SUITE_P(Stripe, EveryMethod,
                         testing::Values(StripeMethod::kAdaptive, StripeMethod::kCentroid,
                                         StripeMethod::kGaussian, StripeMethod::kSteger));

TEST(Stripe, TheAdaptiveOneKeepsAnEdgeAndAveragesSpeckles) {
  const auto ledge = [](int u) { return u < 150 ? 60.3 : 66.8; };
  StripeProfile profile;
  StripeExtractor extractor{StripeOptions{}};
  extractor.extract(drawn(300, 160, 1.2, 180, 4, ledge).view(), {}, profile);
  for (const int u : {148, 149, 150, 151}) {
    ASSERT_EQ(profile.state[static_cast<std::size_t>(u)], StripeState::kGood);
    EXPECT_NEAR(static_cast<double>(profile.at_px[static_cast<std::size_t>(u)]), ledge(u), 0.03) << u;
  }
  // Every column off by its own 0.3 px, as speckles do it.
  std::vector<double> off(300);
  Random random(4);
  for (double& each : off) {
    each = 0.3 * random.normal();
  }
  const auto speckled = [&](int u) { return slanted(u) + off[static_cast<std::size_t>(u)]; };
  const GrayImage image = drawn(300, 160, 1.2, 180, 4, speckled);
  const auto rms = [&](StripeMethod method) {
    StripeOptions options;
    options.method = method;
    StripeExtractor(options).extract(image.view(), {}, profile);
    double squares = 0;
    for (int u = 5; u < 295; ++u) {
      const double error = static_cast<double>(profile.at_px[static_cast<std::size_t>(u)]) - slanted(u);
      squares += error * error;
    }
    return std::sqrt(squares / 290);
  };
  EXPECT_GT(rms(StripeMethod::kCentroid), 0.25);
  EXPECT_LT(rms(StripeMethod::kAdaptive), 0.18);
}

TEST(Stripe, RunsAlongRowsAsWell) {
  const GrayImage across = drawn(120, 160, 1.2, 180, 4, slanted);
  GrayImage down(160, 120);
  for (int v = 0; v < 160; ++v) {
    for (int u = 0; u < 120; ++u) {
      down.pixels[down.index(v, u)] = across.at(u, v);
    }
  }
  StripeOptions options;
  StripeProfile a;
  StripeProfile b;
  StripeExtractor(options).extract(across.view(), {}, a);
  options.axis = StripeAxis::kPerRow;
  StripeExtractor(options).extract(down.view(), {}, b);
  EXPECT_EQ(a.at_px, b.at_px);
}

TEST(Stripe, TallAndTinyImages) {
  const GrayImage tall = drawn(16, 5000, 1.2, 180, 4, [](int) { return 4711.25; });
  StripeProfile profile;
  StripeExtractor extractor{StripeOptions{}};
  extractor.extract(tall.view(), {}, profile);
  ASSERT_EQ(profile.state[8], StripeState::kGood);
  EXPECT_NEAR(static_cast<double>(profile.at_px[8]), 4711.25, 0.03);
  const GrayImage tiny(3, 2, 200);
  extractor.extract(tiny.view(), {}, profile);
  EXPECT_EQ(profile.at_px.size(), 3U);
  extractor.extract({}, {}, profile);
  EXPECT_TRUE(profile.at_px.empty());
}

}  // namespace
}  // namespace dubsar
