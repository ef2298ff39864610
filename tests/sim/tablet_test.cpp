// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/tablet.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "core/units.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

bool same_bytes(const SimTablet& a, const SimTablet& b) {
  const auto& pa = a.mesh.positions;
  const auto& pb = b.mesh.positions;
  return pa.size() == pb.size() &&
         std::memcmp(pa.data(), pb.data(), pa.size() * sizeof(Eigen::Vector3f)) == 0 &&
         a.mesh.faces == b.mesh.faces && a.albedo == b.albedo && a.kinds == b.kinds &&
         a.wedge_of == b.wedge_of && a.wedges.size() == b.wedges.size();
}

double volume_mm3(const Mesh& mesh) {
  double volume = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.positions[f[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[f[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[f[2]].cast<double>();
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

TabletOptions battered() {
  TabletOptions options;
  options.size_mm = {26, 22, 12};
  options.spacing_mm = 0.25;
  options.line_height_mm = 4;
  options.damage = {1, 1, 1, 1, 1};
  return options;
}

class TabletShapes : public testing::TestWithParam<TabletOptions> {};

TEST_P(TabletShapes, IsWatertightAndOrientedOutwards) {
  const SimTablet tablet = make_or_fail(GetParam());
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& f : tablet.mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_TRUE(edges.insert({f[k], f[(k + 1) % 3]}).second);
    }
  }
  for (const auto& [from, to] : edges) {
    ASSERT_TRUE(edges.contains({to, from}));
  }
  const auto v = static_cast<long>(tablet.mesh.positions.size());
  EXPECT_EQ(v - static_cast<long>(edges.size() / 2) + static_cast<long>(tablet.mesh.faces.size()), 2);
  const double box = GetParam().size_mm.prod();
  EXPECT_GT(volume_mm3(tablet.mesh), 0.5 * box);
  EXPECT_LT(volume_mm3(tablet.mesh), box);
  Eigen::Vector3f half = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : tablet.mesh.positions) {
    ASSERT_TRUE(p.allFinite());
    half = half.cwiseMax(p.cwiseAbs());
  }
  EXPECT_LT((2.0 * half.cast<double>() - GetParam().size_mm).cwiseAbs().maxCoeff(), 2.0);
}

TabletOptions sized(double x, double y, double z, double spacing) {
  TabletOptions options;
  options.size_mm = {x, y, z};
  options.spacing_mm = spacing;
  return options;
}

INSTANTIATE_TEST_SUITE_P(Sizes, TabletShapes,
                         testing::Values(small_clean_tablet(), battered(), sized(20, 20, 9, 0.3),
                                         sized(40, 75, 22, 0.6), sized(150, 120, 35, 1.2)));

TEST(Tablet, SpacingIsEvenAndAsAsked) {
  TabletOptions options = small_clean_tablet();
  options.text_density = 0;
  const SimTablet tablet = make_or_fail(options);
  std::vector<double> lengths;
  for (const auto& f : tablet.mesh.faces) {
    // The two shorter sides are lattice edges, the longest the diagonal.
    std::array<double, 3> sides{};
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = (tablet.mesh.positions[f[k]] - tablet.mesh.positions[f[(k + 1) % 3]]).norm();
    }
    std::ranges::sort(sides);
    lengths.push_back(sides[0]);
    lengths.push_back(sides[1]);
  }
  std::ranges::sort(lengths);
  EXPECT_NEAR(lengths[lengths.size() / 2], options.spacing_mm, 0.1 * options.spacing_mm);
  EXPECT_GT(lengths[lengths.size() / 100], 0.5 * options.spacing_mm);
  EXPECT_LT(lengths[lengths.size() * 99 / 100], 1.5 * options.spacing_mm);
}

TEST(Tablet, SameSeedSameBytesOnOneThreadOrTwo) {
  const SimTablet a = make_or_fail(battered());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same_bytes(a, make_or_fail(battered())));
  TabletOptions other = battered();
  other.seed = 2;
  EXPECT_FALSE(same_bytes(a, make_or_fail(other)));
}

TEST(Tablet, DepthPointsOfIntactWedgesLieOnTheMesh) {
  const TabletOptions options = small_clean_tablet();
  const TestScene scene(make_or_fail(options));
  int checked = 0;
  for (const Wedge& wedge : scene.tablet.wedges) {
    if (wedge.intact < 0.99) {
      continue;
    }
    const auto near = scene.query.closest(wedge.depth_point_mm.cast<float>(), 5.0F);
    ASSERT_TRUE(near);
    EXPECT_LT(near->distance_mm, options.spacing_mm) << wedge.id;
    ++checked;
  }
  EXPECT_GT(checked, 20);
}

/// Plane normal of the vertices, towards `out`.
Eigen::Vector3d fitted_normal(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& out) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    cov += (p - mean) * (p - mean).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cov, Eigen::ComputeFullU);
  const Eigen::Vector3d n = svd.matrixU().col(2);
  return n.dot(out) < 0 ? Eigen::Vector3d(-n) : n;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

TEST(Tablet, AnglesMeasuredOnTheMeshAreThoseOfTheTruth) {
  TabletOptions options = small_clean_tablet();
  options.spacing_mm = 0.1;
  const SimTablet tablet = make_or_fail(options);
  int checked = 0;
  for (const Wedge& wedge : tablet.wedges) {
    if (wedge.intact < 0.95) {
      continue;
    }
    std::array<std::vector<Eigen::Vector3d>, 3> sides;
    for (std::size_t i = 0; i < tablet.wedge_of.size(); ++i) {
      if (tablet.wedge_of[i] != wedge.id) {
        continue;
      }
      std::size_t best = 0;
      for (std::size_t k = 1; k < 3; ++k) {
        const Eigen::Vector3f n = tablet.mesh.normals[i];
        best = n.dot(wedge.face_normals[k].cast<float>()) > n.dot(wedge.face_normals[best].cast<float>())
                   ? k
                   : best;
      }
      // Normals at inner edges are blends: only vertices well inside a face count.
      if (tablet.mesh.normals[i].cast<double>().dot(wedge.face_normals[best]) > 0.999) {
        sides[best].push_back(tablet.mesh.positions[i].cast<double>());
      }
    }
    if (std::ranges::any_of(sides, [](const auto& side) { return side.size() < 6; })) {
      continue;
    }
    std::array<Eigen::Vector3d, 3> normals;
    for (std::size_t k = 0; k < 3; ++k) {
      normals[k] = fitted_normal(sides[k], wedge.face_normals[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      // Inner edge k is where faces k-1 and k meet.
      EXPECT_NEAR(180.0 - angle_deg(normals[(k + 2) % 3], normals[k]),
                  deg_from_rad(wedge.opening_angles_rad[k]), 1.0);
      const Eigen::Vector3d down_k = normals[(k + 2) % 3].cross(normals[k]);
      const Eigen::Vector3d down_next = normals[k].cross(normals[(k + 1) % 3]);
      const Eigen::Vector3d edge_k = wedge.exit_points_mm[k] - wedge.depth_point_mm;
      const Eigen::Vector3d edge_next = wedge.exit_points_mm[(k + 1) % 3] - wedge.depth_point_mm;
      EXPECT_NEAR(angle_deg(down_k * (down_k.dot(edge_k) < 0 ? -1 : 1),
                            down_next * (down_next.dot(edge_next) < 0 ? -1 : 1)),
                  deg_from_rad(wedge.face_angles_rad[k]), 1.0);
    }
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

TEST(Tablet, TruthIsConsistent) {
  const SimTablet tablet = make_or_fail(small_clean_tablet());
  ASSERT_GT(tablet.wedges.size(), 40U);
  for (const Wedge& wedge : tablet.wedges) {
    double turn = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d edge = wedge.exit_points_mm[k] - wedge.depth_point_mm;
      EXPECT_NEAR(wedge.face_normals[k].dot(edge), 0, 1e-9);
      EXPECT_NEAR(wedge.face_normals[k].dot(wedge.exit_points_mm[(k + 1) % 3] - wedge.depth_point_mm), 0,
                  1e-9);
      EXPECT_GT(wedge.face_normals[k].dot(wedge.exit_points_mm[(k + 2) % 3] - wedge.depth_point_mm), 0);
      EXPECT_LE(edge.norm(), (wedge.exit_points_mm[static_cast<std::size_t>(wedge.directional_edge)] -
                              wedge.depth_point_mm)
                                 .norm());
      turn += wedge.face_angles_rad[k];
    }
    EXPECT_LT(turn, 2 * kPi);
    EXPECT_GT(wedge.depth_mm, 0.15);
    EXPECT_LT(wedge.depth_mm, 1.5);
    EXPECT_GE(wedge.intact, 0.0);
    EXPECT_LE(wedge.intact, 1.0);
  }
}

/// The clay before it was written on tells what every other test takes for true: how deep a wedge is, and
/// where its edges come out.
TEST(Tablet, DepthsAndExitsOfTheTruthAreThoseOfTheClayThatWasWrittenOn) {
  TabletOptions options = small_clean_tablet();
  const SimTablet written = make_or_fail(options);
  options.text_density = 0;
  const TestScene blank(make_or_fail(options));
  ASSERT_TRUE(blank.tablet.wedges.empty());
  ASSERT_GT(written.wedges.size(), 40U);
  // Facets of 0.15 to 0.3 mm lie 3 to 11 um below clay that bends over a millimetre, and less elsewhere.
  constexpr double kFacetMm = 0.02;
  double depths_mm = 0;
  double nearest_mm = 0;
  for (const Wedge& wedge : written.wedges) {
    const auto above = blank.query.closest(wedge.depth_point_mm.cast<float>(), 5.0F);
    ASSERT_TRUE(above) << wedge.id;
    EXPECT_LT(above->distance_mm, wedge.depth_mm + kFacetMm) << wedge.id;
    depths_mm += wedge.depth_mm;
    nearest_mm += above->distance_mm;
    for (const Eigen::Vector3d& exit : wedge.exit_points_mm) {
      const auto at = blank.query.closest(exit.cast<float>(), 5.0F);
      ASSERT_TRUE(at) << wedge.id;
      EXPECT_LT(at->distance_mm, kFacetMm) << wedge.id;
    }
  }
  // At a rim the clay beside may be nearer than that above.
  EXPECT_GT(nearest_mm, 0.95 * depths_mm);
}

TEST(Tablet, LaterWedgesOverwriteEarlierOnes) {
  const SimTablet tablet = make_or_fail(small_clean_tablet());
  const auto broken = std::ranges::count_if(tablet.wedges, [](const Wedge& w) { return w.intact < 0.95; });
  const auto whole = std::ranges::count_if(tablet.wedges, [](const Wedge& w) { return w.intact > 0.99; });
  EXPECT_GT(broken, 5);
  EXPECT_GT(whole, 20);
}

TEST(Tablet, WritesOnAllSidesThatItShould) {
  const SimTablet tablet = make_or_fail(small_clean_tablet());
  int obverse = 0;
  int reverse = 0;
  int edges = 0;
  for (const Wedge& wedge : tablet.wedges) {
    const double z = (wedge.face_normals[0] + wedge.face_normals[1] + wedge.face_normals[2]).normalized().z();
    obverse += z > 0.7 ? 1 : 0;
    reverse += z < -0.7 ? 1 : 0;
    edges += std::abs(z) < 0.5 ? 1 : 0;
  }
  EXPECT_GT(obverse, 20);
  EXPECT_GT(reverse, 10);
  EXPECT_GT(edges, 5);
}

TEST(Tablet, DamageLeavesEveryKindOfTraceAndBreaksWedges) {
  const SimTablet tablet = make_or_fail(battered());
  for (const SurfaceKind kind : {SurfaceKind::kWedge, SurfaceKind::kFracture, SurfaceKind::kErosion,
                                 SurfaceKind::kDirt, SurfaceKind::kCrack, SurfaceKind::kHole}) {
    EXPECT_GT(std::ranges::count(tablet.kinds, kind), 5) << static_cast<int>(kind);
  }
  TabletOptions whole = battered();
  whole.damage = DamageOptions::none();
  const SimTablet before = make_or_fail(whole);
  ASSERT_EQ(before.wedges.size(), tablet.wedges.size());
  double lost = 0;
  for (std::size_t k = 0; k < before.wedges.size(); ++k) {
    EXPECT_LE(tablet.wedges[k].intact, before.wedges[k].intact + 1e-9);
    lost += before.wedges[k].intact - tablet.wedges[k].intact;
  }
  EXPECT_GT(lost, 2.0);
}

TEST(Tablet, SealReliefIsTwentyMicrometres) {
  TabletOptions options = small_clean_tablet();
  options.text_density = 0;
  const SimTablet blank = make_or_fail(options);
  options.seal_um = 20;
  const SimTablet sealed = make_or_fail(options);
  float low = 0;
  float high = 0;
  for (std::size_t i = 0; i < blank.mesh.positions.size(); ++i) {
    const float rise = blank.mesh.normals[i].dot(sealed.mesh.positions[i] - blank.mesh.positions[i]);
    low = std::min(low, rise);
    high = std::max(high, rise);
  }
  EXPECT_NEAR(high - low, 0.020, 0.002);
}

TEST(Tablet, ComesBackFromItsMesh) {
  const SimTablet made = make_or_fail(battered());
  const SimTablet again = tablet_from_mesh(made.mesh);
  for (std::size_t i = 0; i < made.albedo.size(); ++i) {
    ASSERT_NEAR(again.albedo[i], made.albedo[i], 0.003);
  }
  Mesh bare = made.mesh;
  bare.colours.clear();
  bare.normals.clear();
  const SimTablet even = tablet_from_mesh(bare, 0.7F);
  EXPECT_EQ(even.albedo.front(), 0.7F);
  EXPECT_EQ(even.mesh.normals.size(), bare.positions.size());
}

TEST(Tablet, RefusesWhatCannotBeMade) {
  JobContext job;
  for (const TabletOptions& bad :
       {sized(0, 40, 20, 0.1), sized(50, 40, 1000, 0.1), sized(50, 40, 20, 0), sized(50, 40, 20, -1),
        sized(50, 40, 20, 1e-5), sized(50, 40, 20, 10), sized(NAN, 40, 20, 0.1)}) {
    const Result<SimTablet> tablet = make_tablet(bad, job);
    ASSERT_FALSE(tablet);
    EXPECT_EQ(tablet.error().kind, ErrorKind::kUsage);
  }
  job.cancel();
  const Result<SimTablet> stopped = make_tablet(small_clean_tablet(), job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar::sim
