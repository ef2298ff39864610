// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/averaging_floor.h"

#include <cmath>
#include <optional>

#include "core/mesh_query.h"
#include "core/parallel.h"
#include "triangulation/grid_triangulation.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector3f;

/// One scan's own mesh where it lies, from its well-sampled samples.
struct Sheet {
  Mesh mesh;
  MeshQuery query;

  explicit Sheet(Mesh of) : mesh(std::move(of)), query(mesh) {}
  [[nodiscard]] Vector3f normal(std::uint32_t face) const {
    const auto& f = mesh.faces[face];
    const Vector3f& a = mesh.positions[f[0]];
    return (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a).normalized();
  }
};

Sheet sheet_of(const RangeGrid& grid, const RigidTransform& pose, const SampleFlags& flags) {
  Mesh mesh = triangulate_grid(grid, flags);
  for (Vector3f& p : mesh.positions) {
    p = (pose * p.cast<double>()).cast<float>();
  }
  return Sheet(std::move(mesh));
}

/// Signed distance from the sample to the sheet along the sheet's normal; nothing beyond the sheet's rim or
/// where it faces another way.
std::optional<double> offset_mm(const Vector3f& p, const std::optional<Vector3f>& own_normal,
                                const Sheet& sheet, double reach_mm) {
  constexpr float kSameWay = 0.5F;
  constexpr float kAlongNormal = 0.87F;  // beyond a rim the nearest place lies to the side
  const auto at = sheet.query.closest(p, static_cast<float>(reach_mm));
  if (!at) {
    return std::nullopt;
  }
  const Vector3f normal = sheet.normal(at->face);
  const Vector3f to = at->point_mm - p;
  const float along = to.dot(normal);
  if ((own_normal && normal.dot(*own_normal) < kSameWay) ||
      (to.norm() > 1e-6F && std::abs(along) < kAlongNormal * to.norm())) {
    return std::nullopt;
  }
  return along;
}

}  // namespace

AveragingFloor averaging_floor(const std::vector<std::shared_ptr<const RangeGrid>>& grids,
                               const std::vector<RigidTransform>& poses,
                               const std::vector<SampleFlags>& flags, double reach_mm) {
  constexpr float kOwn = 1e-3F;  // a sample that carries a triangle lies on its scan's mesh
  std::vector<Sheet> sheets;
  sheets.reserve(grids.size());
  for (std::size_t k = 0; k < grids.size(); ++k) {
    sheets.push_back(sheet_of(*grids[k], poses[k], flags[k]));
  }
  AveragingFloor out;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    std::vector<Vector3f> points;
    for (std::size_t i = 0; i < grids[k]->size(); ++i) {
      if (grids[k]->valid[i] != 0) {
        points.push_back((poses[k] * grids[k]->point(i).cast<double>()).cast<float>());
      }
    }
    std::vector<double> residual(points.size(), -1.0);
    parallel_for_each_index(
        points.size(),
        [&](std::size_t i) {
          const auto own = sheets[k].query.closest(points[i], static_cast<float>(reach_mm));
          const std::optional<Vector3f> normal =
              own ? std::optional(sheets[k].normal(own->face)) : std::nullopt;
          double sum = 0;
          int count = own && own->distance_mm < kOwn ? 1 : 0;
          for (std::size_t j = 0; j < sheets.size(); ++j) {
            const auto offset =
                j != k ? offset_mm(points[i], normal, sheets[j], reach_mm) : std::optional<double>{};
            sum += offset.value_or(0.0);
            count += offset ? 1 : 0;
          }
          residual[i] = count > 0 ? std::abs(sum / count) : -1.0;
        },
        256);
    for (const double r : residual) {
      out.alone += r < 0 ? 1U : 0U;
      out.residual_mm.push_back(std::max(r, 0.0));
    }
  }
  return out;
}

}  // namespace dubsar::bench
