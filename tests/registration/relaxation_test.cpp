// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/relaxation.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/random.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

struct Ring {
  std::vector<RigidTransform> truth, start;
  std::vector<bool> fixed;
  std::vector<Eigen::Vector3d> centers_mm;
  std::vector<PairConstraint> pairs;
};

RigidTransform jittered(const RigidTransform& pose, double sigma, Random& random) {
  const Eigen::Vector3d omega = 0.01 * sigma * random.normal3();
  return (RigidTransform::from_twist(omega, sigma * random.normal3()) * pose).orthonormalised();
}

/// Fifteen scans around an object, each measured against the next three.
Ring ring(double noise_mm, std::uint64_t seed) {
  Ring out;
  Random random(seed);
  constexpr int kScans = 15;
  for (int k = 0; k < kScans; ++k) {
    out.truth.push_back(testing::pose_of(0, 24.0 * k, 3.0 * k, {0.2 * k, 1, -2}));
    out.start.push_back(k == 0 ? out.truth.back() : jittered(out.truth.back(), 0.5, random));
    out.fixed.push_back(k == 0);
    out.centers_mm.emplace_back(0, 0, 10);
  }
  for (std::size_t a = 0; a < kScans; ++a) {
    for (std::size_t step = 1; step <= 3; ++step) {
      PairConstraint pair;
      pair.a = a;
      pair.b = (a + step) % kScans;
      pair.a_from_b = jittered(out.truth[pair.a].inverse() * out.truth[pair.b], noise_mm, random);
      pair.information = Matrix6d::Identity() / (noise_mm * noise_mm);
      pair.information.topLeftCorner<3, 3>() *= 1e4;
      out.pairs.push_back(pair);
    }
  }
  return out;
}

TEST(Relaxation, FindsThePosesThatThePairsAgreeOn) {
  const Ring r = ring(1e-3, 1);
  JobContext job;
  const auto relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_TRUE(relaxed);
  for (std::size_t k = 0; k < r.truth.size(); ++k) {
    const RigidTransform& pose = (*relaxed)[k].model_from_scanner;
    EXPECT_LT((pose * r.centers_mm[k] - r.truth[k] * r.centers_mm[k]).norm(), 0.01) << k;
  }
  EXPECT_EQ((*relaxed)[0].model_from_scanner.translation_mm, r.truth[0].translation_mm)
      << "a fixed scan stays";
  EXPECT_TRUE((*relaxed)[0].covariance.isZero());
}

TEST(Relaxation, OneWrongPairDoesNotBendTheRing) {
  Ring r = ring(1e-3, 2);
  r.pairs[20].a_from_b.translation_mm += Eigen::Vector3d(2, 0, 0);
  JobContext job;
  const auto relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_TRUE(relaxed);
  for (std::size_t k = 0; k < r.truth.size(); ++k) {
    EXPECT_LT(((*relaxed)[k].model_from_scanner * r.centers_mm[k] - r.truth[k] * r.centers_mm[k]).norm(),
              0.02);
  }
}

TEST(Relaxation, OfAScanThatNothingConnectsNothingIsKnown) {
  Ring r = ring(1e-3, 4);
  r.fixed[0] = false;
  std::erase_if(r.pairs, [](const PairConstraint& pair) { return pair.a == 0 || pair.b == 0; });
  JobContext job;
  const auto relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_TRUE(relaxed);
  EXPECT_GT((*relaxed)[0].covariance.diagonal().minCoeff(), 1e6);
  EXPECT_TRUE((*relaxed)[1].covariance.isZero()) << "the others lie to their first";
  for (std::size_t k = 2; k < r.truth.size(); ++k) {
    EXPECT_LT((*relaxed)[k].covariance.diagonal().maxCoeff(), 1e-3) << k;
  }
}

TEST(Relaxation, APairSaysTheSameTurned) {
  Ring r = ring(1e-3, 5);
  Random random(6);
  for (PairConstraint& pair : r.pairs) {  // what holds one way more than another, about a place off both
    for (int k = 0; k < 6; ++k) {
      Vector6d axis;
      axis << random.normal3() * 100, random.normal3();
      pair.information += 1e6 * axis * axis.transpose();
    }
    pair.center_mm = {3, -8, 12};
  }
  JobContext job;
  const auto relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  for (std::size_t k = 0; k < r.pairs.size(); k += 2) {
    r.pairs[k] = turned(r.pairs[k]);
  }
  const auto again = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_TRUE(relaxed);
  ASSERT_TRUE(again);
  for (std::size_t k = 0; k < r.truth.size(); ++k) {
    const RelaxedPose& a = (*relaxed)[k];
    const RelaxedPose& b = (*again)[k];
    EXPECT_LT((a.model_from_scanner * r.centers_mm[k] - b.model_from_scanner * r.centers_mm[k]).norm(), 1e-6)
        << k;
    EXPECT_LE((a.covariance - b.covariance).norm(), 1e-3 * a.covariance.norm()) << k;
  }
}

/// Scans in a row, each measured against the next at one of its ends: their errors add up. Taken for the same
/// noise those of a scan's two ends cancelled, and the last of four was as sure as the first.
TEST(Relaxation, SigmaGrowsAlongAChain) {
  constexpr std::size_t kScans = 5;
  std::vector<RigidTransform> start;
  std::vector<PairConstraint> pairs;
  for (std::size_t k = 0; k < kScans; ++k) {
    start.push_back(testing::pose_of(0, 0, 0, {10.0 * static_cast<double>(k), 0, 0}));
  }
  for (std::size_t k = 0; k + 1 < kScans; ++k) {
    PairConstraint pair;
    pair.a = k;
    pair.b = k + 1;
    pair.a_from_b = start[k].inverse() * start[k + 1];
    pair.information.diagonal() << Eigen::Vector3d::Constant(1e12), Eigen::Vector3d::Constant(1e4);
    pair.of_a = {0, 1};
    pair.of_b = {1, 0};
    pairs.push_back(pair);
  }
  const std::vector<bool> fixed{true, false, false, false, false};
  const std::vector<Eigen::Vector3d> centers_mm(kScans, Eigen::Vector3d::Zero());
  JobContext job;
  const auto variance_along = [&](std::size_t scan) {
    const auto relaxed = relax(start, fixed, centers_mm, pairs, {}, job);
    return relaxed ? (*relaxed)[scan].covariance(3, 3) : 0.0;
  };
  EXPECT_NEAR(variance_along(1), 1e-4, 1e-6);
  EXPECT_NEAR(variance_along(4), 4e-4, 4e-6);
  for (PairConstraint& pair : pairs) {
    pair.of_a = pair.of_b = {1, 0};  // all at one place: what lies between two scans brings them together
  }
  EXPECT_NEAR(variance_along(4), 1e-4, 1e-6);
}

TEST(Relaxation, SaysWhatIsWrong) {
  JobContext job;
  Ring r = ring(1e-3, 3);
  r.pairs[4].information(2, 2) = std::numeric_limits<double>::quiet_NaN();
  auto relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_FALSE(relaxed);
  EXPECT_NE(relaxed.error().line().find("not finite"), std::string::npos);
  r = ring(1e-3, 3);
  r.start[3].rotation.setZero();
  relaxed = relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job);
  ASSERT_FALSE(relaxed);
  EXPECT_NE(relaxed.error().line().find("scan 3"), std::string::npos);
  r = ring(1e-3, 3);
  r.pairs[0].b = 99;
  EXPECT_FALSE(relax(r.start, r.fixed, r.centers_mm, r.pairs, {}, job));
}

}  // namespace
}  // namespace dubsar
