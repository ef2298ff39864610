// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/tablet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "sim/body.h"
#include "sim/body_grid.h"
#include "sim/clay.h"
#include "sim/damage.h"
#include "sim/noise.h"

namespace dubsar::sim {

namespace {

constexpr double kMostVertices = 60e6;
constexpr std::size_t kGrain = 2048;
constexpr std::size_t kCountGrain = 1U << 17U;
/// A wedge's vertex that damage or a later wedge has moved by more than this is no longer its own.
constexpr double kIntactMm = 0.03;
constexpr double kErosionRadiusMm = 0.3;
constexpr double kFadeMm = 1.0;
/// Colour of clay; the red laser sees the first channel.
constexpr std::array<float, 3> kClayTint = {1.0F, 0.84F, 0.66F};

Status check(const TabletOptions& options) {
  const Eigen::Vector3d& size = options.size_mm;
  if (!size.allFinite() || size.minCoeff() < 5 || size.maxCoeff() > 300) {
    return fail(ErrorKind::kUsage, "a tablet cannot have this size", "tablet size",
                "give width x height x thickness, each from 5 to 300 mm");
  }
  const double area = 2.0 * (size.x() * size.y() + size.x() * size.z() + size.y() * size.z());
  if (!std::isfinite(options.spacing_mm) || options.spacing_mm <= 0 ||
      area / (options.spacing_mm * options.spacing_mm) > kMostVertices ||
      options.spacing_mm > 0.1 * size.minCoeff()) {
    return fail(ErrorKind::kUsage, "this spacing gives no usable mesh of this size", "tablet spacing",
                "give 0.02 to 0.5 mm for a tablet of usual size");
  }
  return {};
}

/// Puts the grid vertex nearest to each depth point exactly over it, so that the mesh reaches the bottom.
void snap_to_depth_points(const Clay& clay, const TabletBody& body, double spacing_mm, BodyGrid* grid) {
  const double radius = 0.75 * spacing_mm;
  const std::size_t count = grid->points.size();
  std::vector<std::int32_t> near(count);
  parallel_for_each_index(count,
                          [&](std::size_t i) { near[i] = clay.depth_point_near(grid->points[i], radius); });
  std::vector<std::int64_t> winner(clay.impressions().size(), -1);
  const auto away = [&](std::size_t vertex, std::size_t k) {
    return (grid->points[vertex] - clay.impressions()[k].foot_mm()).squaredNorm();
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (near[i] < 0) {
      continue;
    }
    const auto k = static_cast<std::size_t>(near[i]);
    if (winner[k] < 0 || away(i, k) < away(static_cast<std::size_t>(winner[k]), k)) {
      winner[k] = static_cast<std::int64_t>(i);
    }
  }
  for (std::size_t k = 0; k < winner.size(); ++k) {
    if (winner[k] >= 0) {
      const auto i = static_cast<std::size_t>(winner[k]);
      grid->points[i] = clay.impressions()[k].foot_mm();
      grid->normals[i] = body.normal(grid->points[i]);
    }
  }
}

/// Wears the relief down where the tablet is eroded: edges go round, then everything goes lower.
void erode(const BoxLattice& lattice, const std::vector<float>& worn, double spacing_mm,
           std::vector<float>* heights) {
  if (std::ranges::all_of(worn, [](float w) { return w <= 0; })) {
    return;
  }
  const int sweeps = std::clamp(static_cast<int>(std::pow(kErosionRadiusMm / spacing_mm, 2.0)), 1, 60);
  std::vector<float> next(heights->size());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    parallel_for_each_index(heights->size(), [&](std::size_t i) {
      next[i] = (*heights)[i];
      if (worn[i] <= 0) {
        return;
      }
      std::array<std::uint32_t, 4> around{};
      const int count = lattice.neighbours(i, &around);
      float sum = 0;
      for (int k = 0; k < count; ++k) {
        sum += (*heights)[around[static_cast<std::size_t>(k)]];
      }
      next[i] += 0.9F * worn[i] * (sum / static_cast<float>(count) - (*heights)[i]);
    });
    heights->swap(next);
  }
  parallel_for_each_index(heights->size(), [&](std::size_t i) { (*heights)[i] -= 0.06F * worn[i]; });
}

float albedo_at(const TabletOptions& options, const Eigen::Vector3d& p, SurfaceKind kind) {
  double albedo = 0.5 + 0.12 * fractal_noise(p, 9.0, 4, options.seed ^ 0x61);
  // Fire leaves dark clouds on clay.
  const double smoke = 1.3 * fractal_noise(p, 17.0, 5, options.seed ^ 0x62);
  albedo *= 1.0 - 0.65 * std::clamp((smoke - 0.4) / 0.25, 0.0, 1.0);
  if (kind == SurfaceKind::kDirt) {
    albedo = 0.25 + 0.5 * albedo;
  } else if (kind == SurfaceKind::kFracture) {
    albedo = 0.08 + albedo;
  } else if (kind == SurfaceKind::kCrack || kind == SurfaceKind::kHole) {
    albedo *= 0.7;
  }
  return static_cast<float>(std::clamp(albedo, 0.14, 0.95));
}

/// Triangles of the quads. Where a quad spans two faces, its diagonal follows the edge between them.
std::vector<std::array<std::uint32_t, 3>> triangulate(const BodyGrid& grid, const Clay& clay,
                                                      const std::vector<std::int32_t>& facets,
                                                      const std::vector<Eigen::Vector3f>& positions) {
  std::vector<std::array<std::uint32_t, 4>> quads;
  quads.reserve(positions.size());
  grid.lattice.for_each_quad([&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    quads.push_back({a, b, c, d});
  });
  std::vector<std::array<std::uint32_t, 3>> faces(2 * quads.size());
  parallel_for_each_index(quads.size(), [&](std::size_t i) {
    const auto& [a, b, c, d] = quads[i];
    float ac = (positions[a] - positions[c]).squaredNorm();
    float bd = (positions[b] - positions[d]).squaredNorm();
    if (facets[a] != facets[b] || facets[a] != facets[c] || facets[a] != facets[d]) {
      const Eigen::Vector3d p = 0.25 * (grid.points[a] + grid.points[b] + grid.points[c] + grid.points[d]);
      const Eigen::Vector3d n =
          (grid.normals[a] + grid.normals[b] + grid.normals[c] + grid.normals[d]).normalized();
      const Eigen::Vector3f middle = (p + clay.at(p, n).height_mm * n).cast<float>();
      ac = (0.5F * (positions[a] + positions[c]) - middle).squaredNorm();
      bd = (0.5F * (positions[b] + positions[d]) - middle).squaredNorm();
    }
    if (ac <= bd) {
      faces[2 * i] = {a, b, c};
      faces[2 * i + 1] = {a, c, d};
    } else {
      faces[2 * i] = {a, b, d};
      faces[2 * i + 1] = {b, c, d};
    }
  });
  return faces;
}

/// What the writing and the seal left at each vertex of the body's grid, before damage.
struct Impressed {
  std::vector<float> heights, hollows;  ///< mm along the body's normal; `hollows` as the wedge itself left it
  std::vector<float> worn;              ///< how much the place is eroded, 0 to 1
  std::vector<std::int32_t> facets;     ///< which face of which wedge, -1 where there is none
  std::vector<std::int32_t> vertices_made;  ///< by each wedge, of which later ones may have taken some
};

/// Sets the kinds and the wedges of the tablet's vertices, too.
Impressed impress(const BodyGrid& grid, const Clay& clay, const Damage& damage, const JobContext& job,
                  SimTablet* tablet) {
  const std::size_t count = grid.points.size();
  Impressed out;
  out.heights.resize(count);
  out.hollows.resize(count);
  out.worn.resize(count);
  out.facets.resize(count);
  tablet->kinds.resize(count);
  tablet->wedge_of.resize(count);
  using Counts = std::vector<std::int32_t>;
  const Counts none(clay.impressions().size());
  out.vertices_made = parallel_reduce_ordered(
      count, kCountGrain, none,
      [&](std::size_t begin, std::size_t end) {
        Counts made = none;
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          const ClayPoint point = clay.at(grid.points[i], grid.normals[i]);
          out.heights[i] = static_cast<float>(point.height_mm);
          out.hollows[i] = static_cast<float>(point.hollow_mm);
          tablet->kinds[i] = point.kind;
          tablet->wedge_of[i] = point.wedge;
          out.facets[i] = point.wedge < 0 ? -1 : 3 * point.wedge + point.face;
          out.worn[i] = static_cast<float>(damage.erosion(grid.points[i]));
          const int pressed = std::min(point.pressed_count, static_cast<int>(point.pressed.size()));
          for (int k = 0; k < pressed; ++k) {
            ++made[point.pressed[static_cast<std::size_t>(k)]];
          }
        }
        return made;
      },
      [](Counts& total, const Counts& part) {
        std::ranges::transform(total, part, total.begin(), std::plus());
      });
  return out;
}

/// The height at p once dirt has settled and cracks and holes have opened; tells by `kind` which of them it
/// was.
double damaged_height_mm(const Damage& damage, const Eigen::Vector3d& p, double height_mm,
                         SurfaceKind* kind) {
  if (const double dirt = damage.dirt_level_mm(p); dirt > height_mm) {
    height_mm = dirt;
    *kind = SurfaceKind::kDirt;
  }
  if (const double crack = damage.crack_mm(p); crack > 0) {
    height_mm -= crack;
    *kind = SurfaceKind::kCrack;
  }
  if (const double hole = damage.hole_mm(p); hole > 0) {
    height_mm -= hole;
    *kind = SurfaceKind::kHole;
  }
  // Relief that broke off fades out beyond the face: drawn back with it, steep walls would fold over.
  return height_mm * std::max(0.0, 1.0 - damage.broken_off_mm(p) / kFadeMm);
}

/// Positions, colours and albedo of the tablet as time has left it; what is lost belongs to no wedge any
/// more.
void weather(const TabletOptions& options, const BodyGrid& grid, const Damage& damage,
             const Impressed& impressed, const JobContext& job, SimTablet* tablet) {
  const std::size_t count = grid.points.size();
  tablet->mesh.positions.resize(count);
  tablet->mesh.colours.resize(count);
  tablet->albedo.resize(count);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
      SurfaceKind& kind = tablet->kinds[i];
      if (impressed.worn[i] > 0.3F) {
        kind = SurfaceKind::kErosion;
      }
      const double height = damaged_height_mm(damage, grid.points[i], impressed.heights[i], &kind);
      Eigen::Vector3d at = grid.points[i] + height * grid.normals[i];
      if (damage.fracture(&at)) {
        kind = SurfaceKind::kFracture;
        tablet->wedge_of[i] = -1;
      } else if (tablet->wedge_of[i] >= 0 && std::abs(height - impressed.hollows[i]) > kIntactMm) {
        tablet->wedge_of[i] = -1;
      }
      tablet->mesh.positions[i] = at.cast<float>();
      tablet->albedo[i] = albedo_at(options, at, kind);
      for (std::size_t c = 0; c < 3; ++c) {
        tablet->mesh.colours[i][c] =
            static_cast<std::uint8_t>(255.0F * kClayTint[c] * tablet->albedo[i] + 0.5F);
      }
    }
  });
}

/// The wedges as they were impressed, each with what is left of it.
std::vector<Wedge> true_wedges(const Clay& clay, const TabletBody& body,
                               std::span<const std::int32_t> vertices_made,
                               std::span<const std::int32_t> wedge_of) {
  std::vector<Wedge> wedges;
  for (const Impression& impression : clay.impressions()) {
    wedges.push_back(impression.truth(body));
    wedges.back().id = static_cast<int>(wedges.size()) - 1;
  }
  for (const std::int32_t wedge : wedge_of) {
    if (wedge >= 0) {
      ++wedges[static_cast<std::size_t>(wedge)].vertex_count;
    }
  }
  for (std::size_t k = 0; k < wedges.size(); ++k) {
    const double made = vertices_made[k];
    wedges[k].intact = made > 0 ? static_cast<double>(wedges[k].vertex_count) / made : 0.0;
  }
  return wedges;
}

}  // namespace

SimTablet tablet_from_mesh(Mesh mesh, float albedo) {
  SimTablet tablet;
  tablet.mesh = std::move(mesh);
  const std::size_t count = tablet.mesh.positions.size();
  if (tablet.mesh.normals.size() != count) {
    tablet.mesh.normals = vertex_normals(tablet.mesh);
  }
  tablet.albedo.assign(count, albedo);
  if (tablet.mesh.colours.size() == count) {
    for (std::size_t i = 0; i < count; ++i) {
      tablet.albedo[i] = static_cast<float>(tablet.mesh.colours[i][0]) / 255.0F;
    }
  }
  tablet.kinds.assign(count, SurfaceKind::kBody);
  tablet.wedge_of.assign(count, -1);
  return tablet;
}

Result<SimTablet> make_tablet(const TabletOptions& options, JobContext& job) {
  if (Status ok = check(options); !ok) {
    return std::unexpected(ok.error());
  }
  const auto stopped = [&](double fraction) {
    job.progress("tablet", fraction);
    return job.cancelled();
  };
  const std::unexpected<Error> cancelled = fail(ErrorKind::kCancelled, "stopped while making the tablet");
  if (stopped(0.0)) {
    return cancelled;
  }
  const TabletBody body(options.size_mm, options.unevenness_mm, options.seed);
  BodyGrid grid = make_body_grid(body, options.spacing_mm);
  if (stopped(0.3)) {
    return cancelled;
  }
  const Clay clay(options, body);
  const Damage damage(body, options.damage, options.spacing_mm, options.seed);
  snap_to_depth_points(clay, body, options.spacing_mm, &grid);
  if (stopped(0.4)) {
    return cancelled;
  }

  SimTablet tablet;
  Impressed impressed = impress(grid, clay, damage, job, &tablet);
  if (stopped(0.7)) {
    return cancelled;
  }
  erode(grid.lattice, impressed.worn, options.spacing_mm, &impressed.heights);
  weather(options, grid, damage, impressed, job, &tablet);
  if (stopped(0.85)) {
    return cancelled;
  }
  tablet.mesh.faces = triangulate(grid, clay, impressed.facets, tablet.mesh.positions);
  tablet.mesh.normals = vertex_normals(tablet.mesh);
  tablet.wedges = true_wedges(clay, body, impressed.vertices_made, tablet.wedge_of);
  static_cast<void>(stopped(1.0));
  return tablet;
}

}  // namespace dubsar::sim
