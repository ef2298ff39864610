// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/units.h"
#include "registration/pin_advice.h"
#include "registration/pin_merge.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

std::vector<SeenPin> rim_pins() {
  std::vector<SeenPin> tips;
  Random random(8);
  for (int k = 0; k < 15; ++k) {
    const double a = 2 * kPi * (k + random.uniform(-0.25, 0.25)) / 15;
    tips.push_back({k, {30 * std::cos(a), 22 * std::sin(a), random.uniform(-9, 9)}});
  }
  return tips;
}

/// Put back with an error, seen from elsewhere, `kept` of them from `first` on.
std::vector<SeenPin> put_back(const std::vector<SeenPin>& tips, const RigidTransform& pose, std::size_t first,
                              std::size_t kept, std::uint64_t seed, bool labels) {
  Random random(seed);
  std::vector<SeenPin> out;
  for (std::size_t k = 0; k < kept; ++k) {
    SeenPin tip = tips[(first + k) % tips.size()];
    const Eigen::Vector3d off = random.normal3();
    tip.position_mm = pose.inverse() * Eigen::Vector3d(tip.position_mm + 0.3 * off);
    tip.label = labels ? tip.label : -1;
    out.push_back(tip);
  }
  return out;
}

bool right(const PinMatch& match, const RigidTransform& pose) {
  const RigidTransform turn{match.target_from_source.rotation * pose.rotation.transpose(), {0, 0, 0}};
  return turn.angle_rad() < rad_from_deg(5) &&
         (match.target_from_source.translation_mm - pose.translation_mm).norm() < 3;
}

bool among(const std::vector<PinMatch>& matches, const RigidTransform& pose) {
  return std::any_of(matches.begin(), matches.end(), [&](const PinMatch& m) { return right(m, pose); });
}

TEST(PinMatching, FindsThePoseFromLabelsOfWhichSomeAreWrong) {
  const RigidTransform pose = testing::pose_of(150, 20, -60, {5, 6, 7});
  std::vector<SeenPin> source = put_back(rim_pins(), pose, 0, 9, 1, true);
  std::swap(source[0].label, source[4].label);
  const auto found = match_pins(source, put_back(rim_pins(), {}, 2, 9, 2, true), {});
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(right(found.front(), pose));
  EXPECT_GE(found.front().pairs.size(), 6U);  // the mislabelled are matched by their places
  EXPECT_LT(found.front().labels_agree, static_cast<int>(found.front().pairs.size()));
  EXPECT_LT(found.front().rms_mm, 1.2);
  EXPECT_LT(found.front().chance, 1e-3);
}

TEST(PinMatching, FindsThePoseFromThreeLabels) {
  const RigidTransform pose = testing::pose_of(150, 20, -60, {5, 6, 7});
  const auto found =
      match_pins(put_back(rim_pins(), pose, 0, 8, 1, true), put_back(rim_pins(), {}, 5, 8, 2, true), {});
  EXPECT_TRUE(among(found, pose));
}

TEST(PinMatching, FindsThePoseFromDistancesWithHalfMissingOrFalse) {
  int first = 0;
  int any = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RigidTransform pose = testing::pose_of(100, 20 + static_cast<double>(seed), -60, {5, 6, 7});
    std::vector<SeenPin> source = put_back(rim_pins(), pose, 0, 8, seed, false);
    Random random(seed);
    for (int k = 0; k < 4; ++k) {
      source.push_back({-1, pose.inverse() * Eigen::Vector3d{random.uniform(-30, 30), random.uniform(-22, 22),
                                                             random.uniform(-9, 9)}});
    }
    const auto found = match_pins(source, put_back(rim_pins(), {}, 2, 8, seed + 50, false), {});
    ASSERT_LE(found.size(), PinMatchOptions{}.most_candidates);
    first += !found.empty() && right(found.front(), pose) ? 1 : 0;
    any += among(found, pose) ? 1 : 0;
  }
  EXPECT_GE(first, 34);
  EXPECT_GE(any, 38);
}

TEST(PinMatching, GivesEveryPoseOfASymmetricLayout) {
  std::vector<SeenPin> pins;
  for (int k = 0; k < 6; ++k) {
    const double x = 10.0 * (k % 3) - 10;
    pins.push_back({-1, {x, k < 3 ? -8.0 : 8.0, x * x / 40.0}});
  }
  const auto found = match_pins(pins, pins, {});
  ASSERT_GE(found.size(), 2U);
  EXPECT_TRUE(among(found, {}));
  EXPECT_TRUE(among(found, testing::pose_of(0, 0, 180, {0, 0, 0})));
  EXPECT_NEAR(found[0].score, found[1].score, 1e-6);
}

TEST(PinMatching, SaysWhenAMatchingMayBeChance) {
  std::vector<SeenPin> a;
  std::vector<SeenPin> b;
  Random random(3);
  for (int k = 0; k < 8; ++k) {
    a.push_back({-1, {random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-5, 5)}});
    b.push_back({-1, {random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-5, 5)}});
  }
  for (const PinMatch& match : match_pins(a, b, {})) {
    EXPECT_GT(match.chance, 0.05);
  }
  EXPECT_LT(match_pins(a, a, {}).front().chance, 1e-6);
}

TEST(PinMatching, GivesNothingForTooFewOrForALine) {
  EXPECT_TRUE(match_pins({}, {}, {}).empty());
  const std::vector<SeenPin> two{{1, {0, 0, 0}}, {2, {20, 0, 0}}};
  EXPECT_TRUE(match_pins(two, two, {}).empty());
  std::vector<SeenPin> line;
  for (int k = 0; k < 6; ++k) {
    line.push_back({k, {7.0 * k + k * k, 0, 0}});
  }
  EXPECT_TRUE(match_pins(line, line, {}).empty());
  std::vector<SeenPin> bad = rim_pins();
  bad[3].position_mm.x() = std::nan("");
  EXPECT_TRUE(among(match_pins(bad, rim_pins(), {}), {}));
}

TEST(PinMerge, AveragesWhatIsOnePin) {
  std::vector<PlacedPins> scans;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    const RigidTransform pose = testing::pose_of(10.0 * static_cast<double>(seed), 20, 3, {1, 2, 3});
    scans.push_back({put_back(rim_pins(), pose, seed, 10, seed, true), pose});
  }
  scans[2].tips[0].label = 99;
  const std::vector<SeenPin> merged = merged_pins(scans);
  ASSERT_EQ(merged.size(), 15U);
  for (const SeenPin& pin : merged) {
    ASSERT_GE(pin.label, 0);
    ASSERT_LT(pin.label, 15);
    EXPECT_LT((pin.position_mm - rim_pins()[static_cast<std::size_t>(pin.label)].position_mm).norm(),
              4.0 * 0.3 / std::sqrt(pin.placements));
  }
  EXPECT_TRUE(merged_pins({}).empty());
}

TEST(PinMerge, WhatAScanAndItsPartShowIsMeasuredOnce) {
  const auto seen = [](int label, double x_mm) {
    SeenPin out;
    out.label = label;
    out.position_mm = {x_mm, 0, 0};
    out.covariance_mm2 = 0.04 * Eigen::Matrix3d::Identity();
    return out;
  };
  const std::vector<SeenPin> merged = merged_pins(
      std::vector<PlacedPins>{{{seen(-1, 0.2)}, {}, 7},  // whose pins were named in its part alone
                              {{seen(1, 0.2), seen(3, 9.0)}, {}, 7},
                              {{seen(1, 0.2)}, {}, 7},
                              {{seen(2, 0.4)}, {}, 8},
                              {{seen(2, 0.3)}, {}, 9}});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[0].placements, 3);
  EXPECT_NEAR(merged[0].position_mm.x(), 0.3, 1e-12);
  EXPECT_NEAR(merged[0].covariance_mm2(0, 0), 0.04 / 3, 1e-12);
  EXPECT_EQ(merged[0].label, 2) << "which two measurements say, and one does not";
  EXPECT_EQ(merged[1].placements, 1);  // which the part alone was seen to show
  EXPECT_EQ(merged[1].label, 3);
}

ScanPins scan_of(std::vector<SeenPin> tips, int id = 0) {
  return {id, std::move(tips), {0, 0, 0}, 20};
}

TEST(PinAdvice, IsSilentAboutGoodPins) {
  const ScanPins first = scan_of(put_back(rim_pins(), {}, 0, 10, 1, true), 0);
  const ScanPins latest =
      scan_of(put_back(rim_pins(), testing::pose_of(10, 20, 3, {0, 0, 0}), 2, 10, 2, true), 1);
  const PinAdvice advice = advise_pins(latest, {&first, 1});
  EXPECT_EQ(advice.fault, PinFault::kNone) << advice.say;
  EXPECT_TRUE(advice.say.empty());
  EXPECT_LT(advice.turn_sigma_deg, 1.0);
  EXPECT_LT(advice.surface_sigma_mm, 0.6);
}

TEST(PinAdvice, ExpectsTheErrorThatHornMakes) {
  const std::vector<SeenPin> pins = put_back(rim_pins(), {}, 0, 7, 1, true);
  const PinAdvice advice = advise_pins(scan_of(pins), {});
  double sum2 = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const auto found =
        match_pins(put_back(pins, {}, 0, 7, seed, true), put_back(pins, {}, 0, 7, seed + 100, true), {});
    ASSERT_FALSE(found.empty());
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
      for (const double side : {-20.0, 20.0}) {
        sum2 += (found.front().target_from_source * Eigen::Vector3d(side * way) - side * way).squaredNorm();
        ++count;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(sum2 / count) / advice.surface_sigma_mm, 1.0, 0.2);
}

TEST(PinAdvice, AsksForMoreWhereThereAreNone) {
  const PinAdvice none = advise_pins(scan_of({}), {});
  EXPECT_EQ(none.fault, PinFault::kNotSeen);
  const PinAdvice few = advise_pins(
      scan_of({{-1, {-22, 5, 0}}, {-1, {-21, -6, 2}}, {-1, {-2, 15, 1}}, {-1, {-6, -15, 0}}}), {});
  EXPECT_EQ(few.fault, PinFault::kTooFew);
  EXPECT_NE(few.say.find("too few pins are seen, 4"), std::string::npos) << few.say;
  EXPECT_NE(few.say.find("right edge"), std::string::npos) << few.say;
}

TEST(PinAdvice, NamesThePinToMove) {
  const PinAdvice line = advise_pins(
      scan_of({{1, {-20, 0, 0}}, {2, {-8, 0.3, 0}}, {3, {3, -0.2, 0.1}}, {4, {12, 0, 0}}, {5, {21, 0, 0}}}),
      {});
  EXPECT_EQ(line.fault, PinFault::kInLine);
  EXPECT_NE(line.say.find(" edge: pin "), std::string::npos) << line.say;
  EXPECT_TRUE(line.say.find("top") != std::string::npos || line.say.find("bottom") != std::string::npos)
      << line.say;
  const PinAdvice bunched = advise_pins(
      scan_of({{1, {16, 15, 0}}, {2, {21, 13, 1}}, {3, {18, 19, 2}}, {4, {21, 18, 1}}, {5, {16, 18, 1}}}),
      {});
  EXPECT_EQ(bunched.fault, PinFault::kBunched) << bunched.say;
  EXPECT_TRUE(bunched.say.find("left") != std::string::npos ||
              bunched.say.find("bottom") != std::string::npos)
      << bunched.say;
  std::vector<SeenPin> close = rim_pins();
  close[3].position_mm = close[4].position_mm + Eigen::Vector3d(1.2, 0, 0);
  const PinAdvice twins = advise_pins(scan_of(close), {});
  EXPECT_EQ(twins.fault, PinFault::kTooClose);
  EXPECT_TRUE(twins.pin == 3 || twins.pin == 4);
  EXPECT_NE(twins.say.find("(1.2 mm): move it"), std::string::npos) << twins.say;
}

TEST(PinAdvice, ComparesWithEarlierScans) {
  const ScanPins first = scan_of(put_back(rim_pins(), {}, 0, 5, 1, true), 0);
  const PinAdvice apart = advise_pins(scan_of(put_back(rim_pins(), {}, 8, 5, 2, true), 1), {&first, 1});
  EXPECT_EQ(apart.fault, PinFault::kNotShared) << apart.say;
  std::vector<SeenPin> tips = put_back(rim_pins(), {}, 0, 10, 2, true);
  tips[4].position_mm += Eigen::Vector3d(0, 0, 9);
  const ScanPins all = scan_of(put_back(rim_pins(), {}, 0, 10, 1, true), 0);
  const PinAdvice moved = advise_pins(scan_of(tips, 1), {&all, 1});
  EXPECT_EQ(moved.fault, PinFault::kMoved) << moved.say;
  EXPECT_EQ(moved.pin, 4);
  EXPECT_NE(moved.say.find("pin 4 has moved"), std::string::npos) << moved.say;
}

}  // namespace
}  // namespace dubsar
