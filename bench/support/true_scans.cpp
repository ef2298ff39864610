// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/true_scans.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "core/random.h"
#include "core/units.h"
#include "sim/disturbance.h"
#include "sim/pins.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"

namespace dubsar::bench {

namespace {

[[noreturn]] void give_up(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  std::exit(2);
}

/// By the scan's number among those that are made, not among those of the plan: some are made of its even
/// views only.
bool is_gripped(std::size_t scan, const TrueScanOptions& options) {
  const auto every = static_cast<std::size_t>(options.gripped_every);
  return every == 1 || (every > 1 && scan % every == 1);
}

/// Draws lines along x over both faces and makes it a little wider towards +x.
void rule(sim::SimTablet& tablet, const Eigen::Vector3d& size_mm, double every_mm) {
  constexpr double kDepthMm = 0.15;
  constexpr double kWidthMm = 0.25;
  constexpr double kTaper = 0.01;
  for (std::size_t v = 0; v < tablet.mesh.positions.size(); ++v) {
    Eigen::Vector3d p = tablet.mesh.positions[v].cast<double>();
    const double from_line_mm = p.y() - every_mm * std::round(p.y() / every_mm);
    const double deep_mm = kDepthMm * std::exp(-std::pow(from_line_mm / kWidthMm, 2));
    const Eigen::Vector3d normal = tablet.mesh.normals[v].cast<double>();
    if (std::abs(normal.z()) > 0.5) {
      p -= deep_mm * normal;
    }
    p.y() *= 1.0 + kTaper * p.x() / (0.5 * size_mm.x());
    tablet.mesh.positions[v] = p.cast<float>();
  }
  tablet.mesh.normals = vertex_normals(tablet.mesh);
}

}  // namespace

sim::TabletOptions random_tablet(std::uint64_t seed, std::string_view kind, double spacing_mm) {
  Random random(seed * 1000 + 17);
  sim::TabletOptions t;
  t.seed = seed;
  t.size_mm.x() = random.uniform(20, 50);
  t.size_mm.y() = t.size_mm.x() * random.uniform(0.6, 1.2);
  t.size_mm.z() = t.size_mm.x() * random.uniform(0.35, 0.6);
  t.spacing_mm = spacing_mm;
  if (kind == "blank" || kind == "symmetric" || kind == "ruled") {
    t.text_density = 0;
    t.seal_um = 0;
  }
  if (kind == "symmetric") {
    t.size_mm.y() = t.size_mm.x();
  }
  if (kind == "ruled") {
    t.size_mm.y() = 0.8 * t.size_mm.x();
  }
  if (kind == "symmetric" || kind == "ruled") {
    t.unevenness_mm = 0;
    t.grain_um = 4;
    t.damage = sim::DamageOptions::none();
  }
  if (kind == "worn") {
    t.damage = {0.2, 1.0, 1.0, 0.2, 0.0};
    t.text_density = 0.5;
  }
  if (kind == "tiny") {
    t.size_mm *= 20.0 / t.size_mm.maxCoeff();
  }
  return t;
}

std::vector<TrueScan> true_scans(const sim::TabletOptions& tablet_options, const TrueScanOptions& options,
                                 const ScanVisitor& visitor) {
  JobContext job;
  auto tablet = sim::make_tablet(tablet_options, job);
  if (!tablet) {
    give_up(tablet.error());
  }
  if (options.ruled_every_mm > 0) {
    rule(*tablet, tablet_options.size_mm, options.ruled_every_mm);
  }
  const MeshQuery query(tablet->mesh);
  const sim::TriangulationScanner scanner(
      sim::scanner_for(tablet_options.size_mm, options.spacing_mm, options.noise_mm));
  sim::PinOptions pin_options;
  pin_options.seed = options.seed;
  pin_options.tip_diameter_mm = options.tip_diameter_mm;
  const sim::PinStand stand(*tablet, query, pin_options);
  const auto plan = sim::plan_views(options.views, options.seed);
  std::vector<std::size_t> views = options.only;
  for (std::size_t v = 0; options.only.empty() && v < plan.size(); ++v) {
    views.push_back(v);
  }
  std::vector<TrueScan> scans;
  for (const std::size_t v : views) {
    const RigidTransform& pose = plan[v].tablet_from_scanner;
    const bool gripped = is_gripped(scans.size(), options);
    const sim::SimTablet held =
        gripped ? sim::disturbed(*tablet, pose, sim::Disturbance::kGrip, static_cast<int>(v))
                : sim::SimTablet{};
    const std::optional<MeshQuery> held_query = gripped ? std::optional<MeshQuery>(held.mesh) : std::nullopt;
    sim::Scene scene{gripped ? &held : &*tablet, gripped ? &*held_query : &query, {}, std::nullopt};
    if (options.pins != Pins::kNone) {
      scene.pins = sim::standing_pins(stand.placed(static_cast<int>(v)), scene, scanner, pose);
    }
    auto grid = scanner.scan_grid(scene, pose, options.seed * 100 + v, job);
    if (!grid) {
      give_up(grid.error());
    }
    scans.push_back({std::make_shared<const RangeGrid>(std::move(*grid)), pose,
                     sim::clicked_tips(sim::tips_in_scanner(scene.pins, pose), 1.0, options.seed * 100 + v),
                     options.tablet_number});
    if (visitor) {
      visitor(scene, scans.back());
    }
  }
  return scans;
}

PinSet pin_set(const std::vector<TrueScan>& scans, Pins pins) {
  PinSet set;
  for (std::size_t k = 0; k < scans.size() && pins == Pins::kLabelled; ++k) {
    set.tips[static_cast<int>(k)] = scans[k].clicked_tips;
  }
  return set;
}

PairError pair_error(const TrueScan& a, const TrueScan& b, const RigidTransform& a_from_b) {
  const RigidTransform truth = a.tablet_from_scanner.inverse() * b.tablet_from_scanner;
  const Eigen::Vector3d middle_mm = b.tablet_from_scanner.inverse() * Eigen::Vector3d(0, 0, 0);
  const RigidTransform turn{a_from_b.rotation * truth.rotation.transpose(), {0, 0, 0}};
  return {deg_from_rad(turn.angle_rad()), (a_from_b * middle_mm - truth * middle_mm).norm(),
          a.tablet != b.tablet};
}

PairError pair_error(std::span<const TrueScan> scans, const ScanPose& a, const ScanPose& b) {
  return pair_error(scans[static_cast<std::size_t>(a.id)], scans[static_cast<std::size_t>(b.id)],
                    a.model_from_scanner.inverse() * b.model_from_scanner);
}

}  // namespace dubsar::bench
