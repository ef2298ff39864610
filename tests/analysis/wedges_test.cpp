// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The whole chain, from a mesh to wedges, on simulated tablets and on things that hold none.

#include "analysis/wedges.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <map>
#include <string>

#include "analysis/text_frame.h"
#include "core/random.h"
#include "core/units.h"
#include "sim/tablet.h"
#include "tests/analysis/support/pits.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

WedgeSet wedges_of(const Mesh& mesh) {
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(mesh);
  const auto fields = compute_surface_fields(mesh, graph, {}, job);
  EXPECT_TRUE(fields);
  auto set = find_wedges(mesh, graph, *fields, {}, job);
  EXPECT_TRUE(set);
  return *std::move(set);
}

sim::SimTablet tablet(double text_density, const sim::DamageOptions& damage) {
  sim::TabletOptions options;
  options.seed = 12;
  options.size_mm = {30, 26, 12};
  options.spacing_mm = 0.1;
  options.text_density = text_density;
  options.damage = damage;
  JobContext job;
  auto made = sim::make_tablet(options, job);
  EXPECT_TRUE(made);
  return *std::move(made);
}

/// Index of the true wedge within 0.3 mm of each found one, or -1.
std::vector<int> pairs(const std::vector<Wedge>& found, const std::vector<Wedge>& truth) {
  std::vector<int> of(found.size(), -1);
  for (std::size_t f = 0; f < found.size(); ++f) {
    double nearest = 0.3;
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double d = (found[f].depth_point_mm - truth[t].depth_point_mm).norm();
      if (d < nearest) {
        nearest = d;
        of[f] = static_cast<int>(t);
      }
    }
  }
  return of;
}

TEST(Wedges, OfACleanTabletAreFoundAndMeasured) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  const WedgeSet set = wedges_of(made.mesh);
  const std::vector<int> of = pairs(set.wedges, made.wedges);
  std::vector<std::uint8_t> hit(made.wedges.size(), 0);
  int false_ones = 0;
  int directional = 0;
  for (std::size_t f = 0; f < of.size(); ++f) {
    if (of[f] < 0) {
      ++false_ones;
      continue;
    }
    const Wedge& found = set.wedges[f];
    const Wedge& truth = made.wedges[static_cast<std::size_t>(of[f])];
    hit[static_cast<std::size_t>(of[f])] = 1;
    const auto tail = [](const Wedge& w) {
      return (w.exit_points_mm[static_cast<std::size_t>(w.directional_edge)] - w.depth_point_mm).normalized();
    };
    directional += tail(found).dot(tail(truth)) > 0.95 ? 1 : 0;
    EXPECT_NEAR(found.depth_mm, truth.depth_mm, 0.2);
    EXPECT_GT(found.confidence, 0.0);
    EXPECT_LE(found.confidence, 1.0);
  }
  int whole = 0;
  int missed = 0;
  for (std::size_t t = 0; t < hit.size(); ++t) {
    whole += made.wedges[t].intact >= 0.6 ? 1 : 0;
    missed += made.wedges[t].intact >= 0.6 && hit[t] == 0 ? 1 : 0;
  }
  ASSERT_GT(whole, 50);
  EXPECT_LE(missed, 0.05 * whole);
  EXPECT_LE(false_ones, 0.05 * whole);
  EXPECT_GE(directional, 0.9 * static_cast<double>(of.size() - static_cast<std::size_t>(false_ones)));
}

TEST(Wedges, SlopesOfFacesLieWithinTheirSigmasAndEveryEdgeEndsSomewhere) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  const WedgeSet set = wedges_of(made.mesh);
  const std::vector<int> of = pairs(set.wedges, made.wedges);
  int faces = 0;
  int within = 0;
  for (std::size_t f = 0; f < of.size(); ++f) {
    const Wedge& found = set.wedges[f];
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GT((found.exit_points_extent_mm[k] - found.depth_point_mm).norm(), 0.01);
    }
    if (of[f] < 0 || made.wedges[static_cast<std::size_t>(of[f])].intact < 0.6) {
      continue;
    }
    const Wedge& truth = made.wedges[static_cast<std::size_t>(of[f])];
    const auto& exit = truth.exit_points_mm;
    Eigen::Vector3d up = (exit[1] - exit[0]).cross(exit[2] - exit[0]).normalized();
    up = up.dot(found.surface_normal) < 0 ? Eigen::Vector3d(-up) : up;
    for (const Eigen::Vector3d& normal : truth.face_normals) {
      std::size_t own = 0;
      for (std::size_t k = 1; k < 3; ++k) {
        own = normal.dot(found.face_normals[k]) > normal.dot(found.face_normals[own]) ? k : own;
      }
      ++faces;
      within += std::abs(found.face_slopes_rad[own] - std::acos(normal.dot(up))) <=
                        2 * found.sigma.face_slope_rad[own]
                    ? 1
                    : 0;
    }
  }
  ASSERT_GT(faces, 150);
  EXPECT_GT(within, 0.8 * faces);
}

TEST(Wedges, OfTwoFragmentsInOneFileEitherMayRunTheOtherWayRound) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  const auto count = static_cast<std::uint32_t>(made.mesh.positions.size());
  const auto both = [&](bool flipped) {
    Mesh mesh;
    for (const float shift : {0.0F, 40.0F}) {
      for (const Eigen::Vector3f& p : made.mesh.positions) {
        mesh.positions.emplace_back(p + Eigen::Vector3f(shift, 0, 0));
      }
    }
    mesh.faces = made.mesh.faces;
    for (const auto& [a, b, c] : made.mesh.faces) {
      mesh.faces.push_back(flipped ? std::array{a + count, c + count, b + count}
                                   : std::array{a + count, b + count, c + count});
    }
    return wedges_of(mesh).wedges.size();
  };
  const std::size_t whole = both(false);
  EXPECT_GT(whole, 100U);
  EXPECT_EQ(both(true), whole);
}

TEST(Wedges, VerticesOfNoFaceChangeNothing) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  Mesh mesh = made.mesh;
  mesh.reliability.clear();
  const WedgeSet alone = wedges_of(mesh);
  for (int layer = 1; layer <= 4; ++layer) {  // left over by a program that deleted faces only
    for (std::size_t v = 0; v < made.mesh.positions.size(); ++v) {
      mesh.positions.push_back(made.mesh.positions[v] + 0.4F * layer * made.mesh.normals[v]);
    }
  }
  const WedgeSet among = wedges_of(mesh);
  ASSERT_GT(alone.wedges.size(), 50U);
  ASSERT_EQ(among.wedges.size(), alone.wedges.size());
  for (std::size_t i = 0; i < alone.wedges.size(); ++i) {
    EXPECT_EQ(among.wedges[i].depth_point_mm, alone.wedges[i].depth_point_mm) << i;
    EXPECT_EQ(among.wedges[i].depth_mm, alone.wedges[i].depth_mm) << i;
    EXPECT_EQ(among.wedges[i].confidence, alone.wedges[i].confidence) << i;
  }
}

TEST(Wedges, AreTheSameForAnyNumberOfThreads) {
  const sim::SimTablet made = tablet(0.6, {});
  const WedgeSet many = wedges_of(made.mesh);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const WedgeSet few = wedges_of(made.mesh);
  ASSERT_EQ(many.wedges.size(), few.wedges.size());
  ASSERT_EQ(many.rejected.size(), few.rejected.size());
  EXPECT_EQ(many.basin_of, few.basin_of);
  EXPECT_EQ(many.wedge_of, few.wedge_of);
  for (std::size_t i = 0; i < many.wedges.size(); ++i) {
    EXPECT_EQ(many.wedges[i].depth_point_mm, few.wedges[i].depth_point_mm);
    EXPECT_EQ(many.wedges[i].exit_points_mm, few.wedges[i].exit_points_mm);
    EXPECT_EQ(many.wedges[i].confidence, few.wedges[i].confidence);
  }
}

/// A wedge of the usual shape, so deep, alone on a sheet that lies askew.
Mesh one_wedge(double depth_mm, double spacing_mm) {
  pits::Pit pit;
  const double scale = depth_mm / -pit.tip.z();
  pit.tip *= scale;
  for (Eigen::Vector3d& exit : pit.exits) {
    exit *= scale;
  }
  Mesh mesh =
      pits::sheet(6.0 * scale + 14.0, spacing_mm, [&](double x, double y) { return pit.floor(x, y); });
  const Eigen::AngleAxisf askew(0.35F, Eigen::Vector3f(1, 0.6F, 0.3F).normalized());
  for (Eigen::Vector3f& p : mesh.positions) {
    p = askew * p;
  }
  mesh.normals.clear();
  return mesh;
}

TEST(Wedges, OfAMillimetreAndOfFourAreAsDeepAsTheyAre) {
  for (const double depth : {1.0, 4.0}) {
    const WedgeSet set = wedges_of(one_wedge(depth, 0.12 + 0.04 * depth));
    ASSERT_EQ(set.wedges.size(), 1U) << depth;
    const Wedge& wedge = set.wedges.front();
    EXPECT_NEAR(wedge.depth_mm, depth, 0.07 * depth);  // 0.042 and 0.064 of it
    EXPECT_LT(std::abs(wedge.depth_mm - depth), 2 * wedge.sigma.depth_mm) << depth;
    EXPECT_LT(wedge.sigma.depth_mm, 0.055 * depth);
  }
}

TEST(Wedges, OneDeeperThanAnyWritingIsToldToBe) {
  EXPECT_GT(ReconstructionOptions{}.band_mm, JudgeOptions{}.max_depth_mm);
  const WedgeSet set = wedges_of(one_wedge(6.9, 0.6));
  EXPECT_TRUE(set.wedges.empty());
  EXPECT_TRUE(
      std::ranges::any_of(set.rejected, [](const RejectedWedge& r) { return r.reason == "too deep"; }));
}

TEST(Wedges, ThereAreNoneOnABlankTabletAndASphere) {
  EXPECT_TRUE(wedges_of(tablet(0.0, sim::DamageOptions::none()).mesh).wedges.empty());
  Mesh sphere = shapes::unit_sphere(6);
  for (Eigen::Vector3f& p : sphere.positions) {
    p *= 15.0F;
  }
  EXPECT_TRUE(wedges_of(sphere).wedges.empty());
  EXPECT_TRUE(wedges_of(shapes::unit_sphere(0)).wedges.empty());
}

/// Sixteen hollows of one shape on a sheet, 4 mm apart, in clay that is a few micrometres rough.
Mesh hollows(double spacing_mm, double noise_mm, const std::function<double(double, double)>& floor) {
  Random random(7);
  return pits::sheet(16, spacing_mm, [&](double x, double y) {
    const auto within = [](double a) { return a - 4.0 * std::floor(a / 4.0) - 2.0; };
    return std::min(0.0, floor(within(x), within(y))) + noise_mm * random.normal();
  });
}

TEST(Wedges, BowlsAndConesAreNoneAndSaidToBeRound) {
  const auto expect_round = [](const Mesh& mesh, const std::string& what) {
    const WedgeSet set = wedges_of(mesh);
    EXPECT_TRUE(set.wedges.empty()) << what << ": " << set.wedges.size();
    EXPECT_GE(std::ranges::count_if(
                  set.rejected, [](const RejectedWedge& r) { return r.reason.starts_with("it is round"); }),
              12)
        << what;
  };
  // A finger's dents and signs for numbers, so wide and so deep.
  for (const auto& [radius, depth] : {std::pair{0.6, 0.5}, {0.9, 0.5}, {1.0, 0.8}, {0.8, 0.6}}) {
    const double sphere = (radius * radius + depth * depth) / (2 * depth);
    const auto bowl = [&](double x, double y) {
      const double rest = sphere * sphere - x * x - y * y;
      return rest > 0 ? sphere - depth - std::sqrt(rest) : 0.0;
    };
    for (const double noise : {0.003, 0.015}) {
      expect_round(hollows(0.05, noise, bowl), "bowl " + std::to_string(radius) + " " +
                                                   std::to_string(depth) + " " + std::to_string(noise));
    }
  }
  for (const double slope : {0.8, 1.0}) {  // an awl's holes
    const auto cone = [&](double x, double y) { return slope * std::hypot(x, y) - 0.5; };
    expect_round(hollows(0.05, 0.005, cone), "cone " + std::to_string(slope));
  }
}

TEST(Wedges, AThreeSidedShaftWithAFlatFloorIsNone) {
  const auto shaft = [](double x, double y) {
    const double out = std::max({x, -0.5 * x + 0.866 * y, -0.5 * x - 0.866 * y});
    return std::max(-0.5, 5.0 * (out - 0.5));
  };
  EXPECT_TRUE(wedges_of(hollows(0.05, 0.005, shaft)).wedges.empty());
}

TEST(Wedges, BesideBowlsAreFoundAllTheSame) {
  const pits::Pit pit;
  const double spacing = 0.06;
  const Mesh mesh = pits::sheet(24, spacing, [&](double x, double y) {
    const double i = std::floor(x / 4.0);
    const double j = std::floor(y / 4.0);
    const double u = x - 4.0 * i - 2.0;
    const double v = y - 4.0 * j - 2.0;
    const bool bowl = static_cast<int>(std::abs(i + j)) % 3 == 0;
    const double rest = 1.06 * 1.06 - u * u - v * v;
    return !bowl ? pit.floor(u + 0.6, v) : std::min(0.0, 1.06 - 0.5 - std::sqrt(std::max(rest, 0.0)));
  });
  const WedgeSet set = wedges_of(mesh);
  EXPECT_EQ(set.wedges.size(), 24U);
  for (const Wedge& wedge : set.wedges) {
    EXPECT_GT(wedge.confidence, 0.9);
  }
}

TEST(Wedges, AReadingThatHardlyLeadsDoesNotTurnTheTablet) {
  const Mesh slab = shapes::box({50, 40, 20}, 4);
  std::vector<Wedge> wedges;
  const auto point = [&](double deg) {
    Wedge wedge;
    wedge.surface_normal = Eigen::Vector3d::UnitZ();
    wedge.exit_points_surface_mm[0] = {std::cos(rad_from_deg(deg)), std::sin(rad_from_deg(deg)), 0};
    wedge.confidence = 1;
    wedge.directional_margin = 1;
    wedges.push_back(wedge);
  };
  for (int k = 0; k < 4; ++k) {
    point(135);
  }
  const TextFrame few = find_text_frame(slab, wedges);
  EXPECT_EQ(few.certainty, 0);
  EXPECT_GT(few.text_from_model.rotation(0, 0), 0.99);
  wedges.clear();
  for (int k = 0; k < 20; ++k) {
    point(90 * k);
  }
  point(135);  // as it would were the tablet upside down
  const TextFrame doubtful = find_text_frame(slab, wedges);
  EXPECT_GT(doubtful.certainty, 0.01);
  EXPECT_LT(doubtful.certainty, kCertainText);
  EXPECT_GT(doubtful.text_from_model.rotation(0, 0), 0.99);
  for (int k = 0; k < 5; ++k) {
    point(135);
  }
  const TextFrame clear = find_text_frame(slab, wedges);
  EXPECT_GT(clear.certainty, kCertainText);
  EXPECT_LT(clear.text_from_model.rotation(0, 0), -0.99);
}

TEST(Wedges, StandInLinesAsTheyWereWritten) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  WedgeSet set = wedges_of(made.mesh);
  const TextFrame frame = find_text_frame(made.mesh, set.wedges);
  EXPECT_GT(frame.certainty, 0.2);
  // The reader's right is the tablet's x, whichever broad side was taken for the obverse.
  EXPECT_GT((frame.text_from_model.rotation.row(0) * Eigen::Vector3d::UnitX()).value(), 0.95);
  place_wedges(frame, &set.wedges);
  const std::vector<int> of = pairs(set.wedges, made.wedges);
  // True wedges are numbered as they were written: along a line the numbers rise, but for strokes of a sign.
  std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> lines;
  for (std::size_t f = 0; f < of.size(); ++f) {
    const WedgePlace& place = set.wedges[f].place;
    ASSERT_TRUE(place.side);
    ASSERT_GT(place.line, 0);
    if (of[f] >= 0 && (*place.side == Face::kObverse || *place.side == Face::kReverse)) {
      lines[{static_cast<int>(*place.side), place.line}].emplace_back(place.order, of[f]);
    }
  }
  ASSERT_GT(lines.size(), 4U);
  int pairs_seen = 0;
  int rising = 0;
  for (auto& [key, line] : lines) {
    std::ranges::sort(line);
    for (std::size_t i = 5; i < line.size(); ++i) {
      ++pairs_seen;
      rising += line[i].second > line[i - 5].second ? 1 : 0;
    }
  }
  EXPECT_GT(rising, 0.85 * pairs_seen);
}

}  // namespace
}  // namespace dubsar
