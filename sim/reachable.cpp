// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/reachable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/random.h"
#include "core/sphere_directions.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr double kShadowMarginMm = 0.02;

}  // namespace

void spread_over(const Mesh& mesh, std::size_t samples, std::uint64_t seed,
                 std::vector<Eigen::Vector3f>* points, std::vector<Eigen::Vector3f>* all_normals) {
  std::vector<double> areas(mesh.faces.size());
  std::vector<Eigen::Vector3f> normals(mesh.faces.size());
  parallel_for_each_index(mesh.faces.size(), [&](std::size_t f) {
    const auto& face = mesh.faces[f];
    const Eigen::Vector3f cross = (mesh.positions[face[1]] - mesh.positions[face[0]])
                                      .cross(mesh.positions[face[2]] - mesh.positions[face[0]]);
    areas[f] = 0.5 * cross.norm();
    normals[f] = cross.normalized();
  });
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  Random random(seed_for(seed, 71));
  double passed = 0;
  std::size_t f = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double at = total * (static_cast<double>(i) + random.uniform()) / static_cast<double>(samples);
    while (f + 1 < areas.size() && passed + areas[f] < at) {
      passed += areas[f++];
    }
    const double root = std::sqrt(random.uniform());
    const double split = random.uniform();
    const auto& face = mesh.faces[f];
    points->emplace_back(static_cast<float>(1.0 - root) * mesh.positions[face[0]] +
                         static_cast<float>(root * (1.0 - split)) * mesh.positions[face[1]] +
                         static_cast<float>(root * split) * mesh.positions[face[2]]);
    all_normals->push_back(normals[f]);
  }
}

Result<std::vector<std::uint8_t>> reachable_points(const std::vector<Eigen::Vector3f>& points,
                                                   const std::vector<Eigen::Vector3f>& normals,
                                                   const MeshQuery& query, const ScannerOptions& scanner,
                                                   const ReachOptions& options, JobContext& job) {
  std::vector<std::uint8_t> reachable(points.size(), 0);
  const std::vector<Eigen::Vector3d> directions =
      sphere_directions(static_cast<std::size_t>(options.directions));
  const double flattest = std::cos(rad_from_deg(options.max_slope_deg));
  const auto seen = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n, const Eigen::Vector3d& from) {
    const Eigen::Matrix3d level =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), from).toRotationMatrix();
    for (int roll = 0; roll < options.rolls; ++roll) {
      const Eigen::Matrix3d r =
          level * Eigen::AngleAxisd(2.0 * kPi * roll / options.rolls, Eigen::Vector3d::UnitZ());
      const double y = r.col(1).dot(p);
      const Eigen::Vector3d laser = r * Eigen::Vector3d(0, y, scanner.standoff_mm);
      const Eigen::Vector3d camera = r * Eigen::Vector3d(0, y + scanner.baseline_mm, scanner.standoff_mm);
      if (n.dot((laser - p).normalized()) < flattest || n.dot((camera - p).normalized()) < flattest) {
        continue;
      }
      const Eigen::Vector3f start = p.cast<float>();
      if (!query.occluded(start, laser.cast<float>(), kShadowMarginMm) &&
          !query.occluded(start, camera.cast<float>(), kShadowMarginMm)) {
        return true;
      }
    }
    return false;
  };
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        if (job.cancelled()) {
          return;
        }
        const Eigen::Vector3d p = points[i].cast<double>();
        const Eigen::Vector3d n = normals[i].cast<double>();
        std::vector<std::pair<double, int>> order;
        for (int d = 0; d < options.directions; ++d) {
          const double facing = n.dot(directions[static_cast<std::size_t>(d)]);
          if (facing > 0.8 * flattest) {
            order.emplace_back(-facing, d);
          }
        }
        // Straight down the normal first: nearly every point is settled by its first few directions.
        std::ranges::sort(order);
        reachable[i] = std::ranges::any_of(order, [&](const auto& entry) {
          return seen(p, n, directions[static_cast<std::size_t>(entry.second)]);
        });
      },
      64);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped while looking for what can be reached");
  }
  return reachable;
}

Result<Reach> reachable_surface(const SimTablet& tablet, const MeshQuery& query,
                                const ScannerOptions& scanner, const ReachOptions& options, JobContext& job) {
  Reach reach;
  if (tablet.mesh.faces.empty() || options.samples == 0) {
    return reach;
  }
  spread_over(tablet.mesh, options.samples, options.seed, &reach.points, &reach.normals);
  Result<std::vector<std::uint8_t>> reachable =
      reachable_points(reach.points, reach.normals, query, scanner, options, job);
  if (!reachable) {
    return std::unexpected(reachable.error());
  }
  reach.reachable = std::move(*reachable);
  const auto count = std::ranges::count(reach.reachable, std::uint8_t{1});
  reach.share = static_cast<double>(count) / static_cast<double>(reach.points.size());
  return reach;
}

}  // namespace dubsar::sim
