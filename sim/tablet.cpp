// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/tablet.h"

#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "sim/body.h"
#include "sim/body_grid.h"
#include "sim/noise.h"
#include "sim/press_index.h"
#include "sim/script.h"

namespace dubsar::sim {

namespace {

constexpr double kMostVertices = 60e6;
constexpr std::size_t kGrain = 4096;

Status check(const TabletOptions& options) {
  const Eigen::Vector3d& size = options.size_mm;
  if (!size.allFinite() || size.minCoeff() < 5 || size.maxCoeff() > 300) {
    return fail(ErrorKind::kUsage, "a tablet cannot have this size", "tablet size",
                "give width x height x thickness, each from 5 to 300 mm");
  }
  const double area = 2.0 * (size.x() * size.y() + size.x() * size.z() + size.y() * size.z());
  if (!std::isfinite(options.spacing_mm) || options.spacing_mm <= 0 ||
      area / (options.spacing_mm * options.spacing_mm) > kMostVertices ||
      options.spacing_mm > 0.2 * size.minCoeff()) {
    return fail(ErrorKind::kUsage, "this spacing gives no usable mesh of this size", "tablet spacing",
                "give 0.02 to 0.5 mm for a tablet of usual size");
  }
  return {};
}

/// The surface over the base grid, vertex by vertex.
struct Relief {
  std::vector<float> height;        ///< mm along the base normal
  std::vector<std::int32_t> owner;  ///< impression that made the surface, or -1
};

double grain_mm(const TabletOptions& options, const Eigen::Vector3d& p) {
  if (options.grain_um <= 0) {
    return 0;
  }
  return 0.001 * options.grain_um *
         (1.1 * value_noise(p, 1.7, options.seed ^ 0x51) +
          0.7 * fractal_noise(p, 0.45, 3, options.seed ^ 0x52));
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const BoxLattice& lattice,
                                                      const std::vector<Eigen::Vector3f>& positions) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(2 * lattice.vertex_count());
  lattice.for_each_quad([&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const float ac = (positions[a] - positions[c]).squaredNorm();
    const float bd = (positions[b] - positions[d]).squaredNorm();
    if (ac <= bd) {
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    } else {
      faces.push_back({a, b, d});
      faces.push_back({b, c, d});
    }
  });
  return faces;
}

}  // namespace

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
  const BodyGrid grid = make_body_grid(body, options.spacing_mm);
  if (stopped(0.3)) {
    return cancelled;
  }
  ScriptOptions script;
  script.seed = options.seed;
  script.density = options.text_density;
  script.line_height_mm = options.line_height_mm;
  script.edges = options.text_on_edges;
  const std::vector<Impression> impressions = write_text(body, script);
  const PressIndex index(impressions, body.half_size_mm());
  if (stopped(0.4)) {
    return cancelled;
  }

  const std::size_t count = grid.points.size();
  SimTablet tablet;
  tablet.mesh.positions.resize(count);
  tablet.albedo.resize(count);
  tablet.kinds.assign(count, SurfaceKind::kBody);
  tablet.wedge_of.assign(count, -1);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    if (job.cancelled()) {
      return;
    }
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d& p = grid.points[i];
      const Eigen::Vector3d& n = grid.normals[i];
      const double grain = grain_mm(options, p);
      double height = grain;
      for (const std::uint32_t k : index.near(p)) {
        bool cut = false;
        height = impressions[k].press(p, n, height, &cut);
        if (cut) {
          tablet.wedge_of[i] = static_cast<std::int32_t>(k);
          tablet.kinds[i] = SurfaceKind::kWedge;
        }
      }
      tablet.mesh.positions[i] = (p + height * n).cast<float>();
      tablet.albedo[i] = static_cast<float>(0.5 + 0.1 * fractal_noise(p, 9.0, 4, options.seed ^ 0x61));
    }
  });
  if (stopped(0.8)) {
    return cancelled;
  }
  tablet.mesh.faces = triangulate(grid.lattice, tablet.mesh.positions);
  tablet.mesh.normals = vertex_normals(tablet.mesh);
  for (std::size_t k = 0; k < impressions.size(); ++k) {
    Wedge wedge = impressions[k].truth(body);
    wedge.id = static_cast<int>(k);
    tablet.wedges.push_back(wedge);
  }
  stopped(1.0);
  return tablet;
}

}  // namespace dubsar::sim
