// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Clearing against steps 3 and 4 of seed 001, 3.3 as they read: every sparse sample against every sample of
// every other scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "core/units.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"
#include "tests/support/height_field.h"

namespace dubsar {
namespace {

struct Scan {
  RangeGrid grid;
  SampleFlags flags;
  RigidTransform pose;
  [[nodiscard]] PlacedScan placed(int id) const { return {id, &grid, &flags, pose, 0.01}; }
};

/// Turned by up to a third of a turn about the model's centre, and not quite there.
RigidTransform random_pose(Random& random, double turn_rad) {
  const Eigen::Vector3d axis = random.normal3();
  const Eigen::Vector3d shift = random.normal3();
  return RigidTransform::from_twist(axis.normalized() * random.uniform(0.0, turn_rad), 0.2 * shift);
}

/// A bumpy sheet with a step, holes, drop-outs and noise.
Scan random_scan(Random& random) {
  Scan scan;
  const double phase = random.uniform(0.0, 6.0);
  scan.grid = test::height_field(34, 40, 0.1, [&](double x, double y) {
    return 0.3 * std::sin(2.0 * x + phase) + 0.2 * y + (x > 0.8 ? 0.9 : 0.0) + 0.02 * random.normal();
  });
  scan.grid.view.camera_mm = Eigen::Vector3d(2.0, 0.0, 30.0);
  for (std::size_t i = 0; i < scan.grid.size(); ++i) {
    const double hole = std::hypot(static_cast<double>(scan.grid.x[i]) + 1.0, scan.grid.y[i] - 0.5);
    scan.grid.valid[i] = hole > 0.35 && random.uniform() > 0.04 ? 1 : 0;
  }
  scan.flags = flag_sparse(scan.grid);
  scan.pose = random_pose(random, rad_from_deg(120));
  return scan;
}

enum class Answer { kNo, kYes, kEither };

/// kEither where rounding may decide.
Answer clears(const Scan& own, std::size_t i, const Scan& other, const ClearingOptions& options) {
  const RigidTransform other_from_own = other.pose.inverse() * own.pose;
  const Eigen::Vector3d p = other_from_own * own.grid.point(i).cast<double>();
  const Eigen::Vector3d facing =
      other_from_own.rotation * own.grid.view.to_camera(own.grid.point(i).cast<double>(), own.grid.row_of(i));
  const double radius_mm = matching_radius_mm(own.grid, noise_of(own.placed(0)), 0.01, other.grid,
                                              noise_of(other.placed(0)), 0.01, options);
  Answer answer = Answer::kNo;
  for (std::size_t j = 0; j < other.grid.size(); ++j) {
    if (other.grid.valid[j] == 0 || !is_unflagged(other.flags[j])) {
      continue;
    }
    const double off_mm = (other.grid.point(j).cast<double>() - p).norm() - radius_mm;
    const Eigen::Vector3d n = sample_normal(other.grid, j, 0.5F).cast<double>();
    const double turned = n.isZero() ? 1.0 : n.dot(facing) - std::cos(options.max_normal_angle_rad);
    if (off_mm < -1e-5 && turned > 0.005) {
      return Answer::kYes;
    }
    if (off_mm < 1e-5 && turned > -0.005) {
      answer = Answer::kEither;
    }
  }
  return answer;
}

TEST(ClearingReference, EveryStateIsWhatTheStepsSay) {
  Random random(31);
  const ClearingOptions options;
  int cleared = 0;
  int red = 0;
  for (int round = 0; round < 4; ++round) {
    std::vector<Scan> scans;
    for (int k = 0; k < 3; ++k) {
      scans.push_back(random_scan(random));
    }
    ClearedMap map(options);
    for (int k = 0; k < 3; ++k) {
      map.add(scans[static_cast<std::size_t>(k)].placed(k));
    }
    for (int k = 0; k < 3; ++k) {
      const Scan& own = scans[static_cast<std::size_t>(k)];
      const SampleFlags& flags = *map.flags(k);
      const std::vector<int> by = map.cleared_by(k);
      for (std::size_t i = 0; i < own.grid.size(); ++i) {
        const bool sparse = (own.flags[i] & kSparse) != 0;
        std::vector<Answer> answers(3, Answer::kNo);
        for (int other = 0; other < 3 && sparse; ++other) {
          if (other != k) {
            answers[static_cast<std::size_t>(other)] =
                clears(own, i, scans[static_cast<std::size_t>(other)], options);
          }
        }
        const bool told = (flags[i] & kCleared) != 0;
        EXPECT_EQ(told, by[i] >= 0);
        const bool yes = std::count(answers.begin(), answers.end(), Answer::kYes) > 0;
        const bool no = std::count(answers.begin(), answers.end(), Answer::kNo) == 3;
        EXPECT_TRUE(told ? !no : !yes) << "scan " << k << " sample " << i;
        if (told) {
          EXPECT_NE(answers[static_cast<std::size_t>(by[i])], Answer::kNo);
        }
        EXPECT_EQ(flags[i] & ~kCleared, own.flags[i]);
        cleared += told ? 1 : 0;
        red += is_red(flags[i]) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(cleared, 500);
  EXPECT_GT(red, 500);
}

TEST(ClearingReference, ARegistrationThatMovesScansLeavesWhatAddingAfreshWould) {
  Random random(5);
  std::vector<Scan> scans;
  ClearedMap map;
  for (int k = 0; k < 4; ++k) {
    scans.push_back(random_scan(random));
  }
  for (int k = 0; k < 4; ++k) {
    map.add(scans[static_cast<std::size_t>(k)].placed(k));
  }
  const auto expect_as_afresh = [&](const ClearedMap& moved) {
    ClearedMap afresh;
    for (int k = 3; k >= 0; --k) {
      afresh.add(scans[static_cast<std::size_t>(k)].placed(k));
    }
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(*moved.flags(k), *afresh.flags(k)) << k;
      EXPECT_EQ(moved.cleared_by(k), afresh.cleared_by(k)) << k;
    }
  };
  for (int round = 0; round < 5; ++round) {
    std::vector<ClearedMap::NewPose> poses;
    for (int k = 0; k < 4; ++k) {
      Scan& scan = scans[static_cast<std::size_t>(k)];
      if (random.uniform() < 0.6) {
        scan.pose = random_pose(random, rad_from_deg(20)) * scan.pose;
      }
      poses.push_back({k, scan.pose, 0.01});
    }
    if (round % 2 == 0) {
      map.reposition(poses, 0.0);
    } else {
      for (const ClearedMap::NewPose& pose : poses) {
        map.reposition(pose.id, pose.model_from_scanner, pose.sigma_mm);
      }
    }
    expect_as_afresh(map);
  }
  // The pose's uncertainty widens the match: that alone is a change too.
  const ClearedMap::NewPose unsure{2, scans[2].pose, 0.2};
  const SampleFlags before = *map.flags(2);
  map.reposition({&unsure, 1}, 0.0);
  EXPECT_NE(*map.flags(2), before);
}

TEST(ClearingReference, AModelThatMovesAsAWholeStaysAsItIs) {
  Random random(9);
  std::vector<Scan> scans;
  ClearedMap map;
  for (int k = 0; k < 3; ++k) {
    scans.push_back(random_scan(random));
  }
  for (int k = 0; k < 3; ++k) {
    map.add(scans[static_cast<std::size_t>(k)].placed(k));
  }
  std::vector<SampleFlags> before;
  std::vector<ClearedMap::NewPose> poses;
  const RigidTransform all = random_pose(random, 1.0);
  for (int k = 0; k < 3; ++k) {
    before.push_back(*map.flags(k));
    poses.push_back({k, all * scans[static_cast<std::size_t>(k)].pose, 0.01});
  }
  // One of them by a fifth of µ more: that is within the tolerance.
  poses[1].model_from_scanner.translation_mm.x() += 0.02;
  map.reposition(poses, 0.25);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(*map.flags(k), before[static_cast<std::size_t>(k)]);
    EXPECT_EQ(map.scans()[static_cast<std::size_t>(k)].model_from_scanner.translation_mm,
              poses[static_cast<std::size_t>(k)].model_from_scanner.translation_mm);
  }
  // Small steps add up: what counts is how the pair lay when it was matched.
  for (int step = 0; step < 5; ++step) {
    poses[1].model_from_scanner.translation_mm.x() += 0.02;
    map.reposition(poses, 0.25);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    scans[k].pose = poses[k].model_from_scanner;
  }
  map.reposition(poses, 0.0);
  ClearedMap afresh;
  for (int k = 0; k < 3; ++k) {
    afresh.add(scans[static_cast<std::size_t>(k)].placed(k));
  }
  EXPECT_EQ(*map.flags(1), *afresh.flags(1));
}

TEST(SampleNormals, AreThoseOfEachSample) {
  Random random(3);
  const Scan scan = random_scan(random);
  const SampleNormals normals = normals_of(scan.grid);
  for (std::size_t i = 0; i < scan.grid.size(); ++i) {
    if (scan.grid.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3f expected = sample_normal(scan.grid, i, 0.5F);
    EXPECT_EQ(normals[i].isZero(), expected.isZero());
    EXPECT_LT((normals[i] - expected).norm(), 0.004F) << i;
  }
}

}  // namespace
}  // namespace dubsar
