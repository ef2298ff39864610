// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/model_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "planning/clearing.h"
#include "planning/completion.h"
#include "planning/convex_hull.h"
#include "planning/hull_air.h"
#include "planning/patch_rays.h"

namespace dubsar {

namespace {

/// Notes which scan surveyed each cell of space first, so that ten scans of one place give one surface. A
/// cell that its first scan only touched is open to the others.
class OwnerGrid {
 public:
  OwnerGrid(const Eigen::AlignedBox3d& box, double cell_mm) : low_(box.min()), cell_mm_(cell_mm) {
    constexpr double kMaxCells = 6.0e6;
    const Eigen::Vector3d extent = box.sizes();
    while ((extent.x() / cell_mm_ + 2) * (extent.y() / cell_mm_ + 2) * (extent.z() / cell_mm_ + 2) >
           kMaxCells) {
      cell_mm_ *= 1.25;
    }
    for (int k = 0; k < 3; ++k) {
      size_[static_cast<std::size_t>(k)] = static_cast<std::size_t>(extent[k] / cell_mm_) + 2;
    }
    owner_.assign(size_[0] * size_[1] * size_[2], -1);
    triangles_.assign(owner_.size(), 0);
  }

  /// True when a triangle of the scan is wanted at p.
  bool claim(const Eigen::Vector3f& p_mm, int scan) {
    std::size_t index = 0;
    for (std::size_t k = 3; k-- > 0;) {
      const double at =
          (static_cast<double>(p_mm[static_cast<int>(k)]) - low_[static_cast<int>(k)]) / cell_mm_;
      const auto cell = static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(size_[k] - 1)));
      index = index * size_[k] + cell;
    }
    if (owner_[index] < 0) {
      owner_[index] = scan;
    }
    if (owner_[index] != scan && triangles_[index] >= kFull) {
      return false;
    }
    triangles_[index] = static_cast<std::uint8_t>(std::min(triangles_[index] + 1, 255));
    return true;
  }

 private:
  /// A flat surface across a cell of two steps makes eight triangles.
  static constexpr std::uint8_t kFull = 8;

  Eigen::Vector3d low_;
  double cell_mm_;
  std::array<std::size_t, 3> size_{};
  std::vector<int> owner_;
  std::vector<std::uint8_t> triangles_;
};

bool carries(const PlacedScan& scan, std::size_t i) {
  return scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) && scan.grid->point(i).allFinite();
}

Eigen::AlignedBox3d box_of(std::span<const PlacedScan> scans) {
  Eigen::AlignedBox3d box;
  for (const PlacedScan& scan : scans) {
    const std::size_t stride = std::max<std::size_t>(1, scan.grid->size() / 20000);
    for (std::size_t i = 0; i < scan.grid->size(); i += stride) {
      if (carries(scan, i)) {
        box.extend(scan.model_from_scanner * scan.grid->point(i).cast<double>());
      }
    }
  }
  return box;
}

/// Thinned triangles of one scan, their corners towards the scanner counter-clockwise.
void add_scan(const PlacedScan& scan, int number, double step_mm, OwnerGrid& owners, Mesh& mesh) {
  const RangeGrid& grid = *scan.grid;
  const double spacing_mm = std::max(spacing_of(grid), 1e-6);
  const int stride = std::max(1, static_cast<int>(std::lround(step_mm / spacing_mm)));
  const auto longest2 = static_cast<float>(std::pow(3.0 * stride * spacing_mm * 1.5, 2.0));
  const int rows = grid.rows / stride;
  const int cols = grid.cols / stride;
  const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
  const Eigen::Vector3f translation = scan.model_from_scanner.translation_mm.cast<float>();
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> vertex(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), kNone);
  const auto source = [&](int r, int c) { return grid.index(r * stride, c * stride); };
  const auto vertex_of = [&](int r, int c) {
    std::uint32_t& v =
        vertex[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c)];
    if (v == kNone) {
      v = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(rotation * grid.point(source(r, c)) + translation);
    }
    return v;
  };
  const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
    std::array<Eigen::Vector3f, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = source(corners[k][0], corners[k][1]);
      if (!carries(scan, i)) {
        return;
      }
      p[k] = grid.point(i);
    }
    if ((p[1] - p[0]).squaredNorm() > longest2 || (p[2] - p[1]).squaredNorm() > longest2 ||
        (p[0] - p[2]).squaredNorm() > 2 * longest2) {
      return;
    }
    if (!owners.claim(rotation * ((p[0] + p[1] + p[2]) / 3.0F) + translation, number)) {
      return;
    }
    const Eigen::Vector3f towards =
        grid.view.to_camera(p[0].cast<double>(), corners[0][0] * stride).cast<float>();
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(towards) < 0) {
      std::swap(corners[1], corners[2]);
    }
    mesh.faces.push_back({vertex_of(corners[0][0], corners[0][1]), vertex_of(corners[1][0], corners[1][1]),
                          vertex_of(corners[2][0], corners[2][1])});
  };
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < cols; ++c) {
      add({{{r, c}, {r, c + 1}, {r + 1, c + 1}}});
      add({{{r, c}, {r + 1, c + 1}, {r + 1, c}}});
    }
  }
}

}  // namespace

Mesh thinned_surface(std::span<const PlacedScan> scans, double step_mm) {
  Mesh mesh;
  const Eigen::AlignedBox3d box = box_of(scans);
  if (box.isEmpty()) {
    return mesh;
  }
  OwnerGrid owners(box, 2.0 * step_mm);
  for (std::size_t k = 0; k < scans.size(); ++k) {
    add_scan(scans[k], static_cast<int>(k), step_mm, owners, mesh);
  }
  return mesh;
}

namespace {

/// Corners of equal small triangles that a hull face is cut into, about `step_mm` apart.
void sample_face(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double step_mm,
                 double& carry, std::vector<SurfacePatch>& out) {
  const Eigen::Vector3d cross = (b - a).cross(c - a);
  const double area = 0.5 * cross.norm();
  if (!(area > 0)) {
    return;
  }
  const Eigen::Vector3d normal = cross.normalized();
  const double cell = step_mm * step_mm;
  // Small faces share samples: `carry` is the area that has not been sampled yet.
  carry += area;
  const auto count = static_cast<std::size_t>(carry / cell);
  carry -= static_cast<double>(count) * cell;
  for (std::size_t k = 0; k < count; ++k) {
    // Low-discrepancy points of the triangle (R2 sequence, folded).
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(k + 1), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(k + 1), 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    out.push_back({a + u * (b - a) + v * (c - a), normal, cell});
  }
}

}  // namespace

bool seen_from_outside(const MeshQuery& query, const SurfacePatch& patch, double step_mm) {
  constexpr int kEnough = 3;
  const Eigen::Vector3f n = patch.normal.cast<float>();
  int hits = 0;
  for (const Eigen::Vector3d& from : patch_ray_starts(patch, step_mm)) {
    const auto hit = query.first_hit(from.cast<float>(), -n, 0.0F, static_cast<float>(kFarFromPatchMm));
    hits += hit && hit->normal.dot(n) > 0 ? 1 : 0;
    if (hits >= kEnough) {
      return true;
    }
  }
  return false;
}

ModelSurface model_surface(std::span<const PlacedScan> scans, const Mesh* model,
                           const ModelSurfaceOptions& options) {
  const double spacing_mm = coarsest_spacing_mm(scans);
  const Eigen::AlignedBox3d box = box_of(scans);
  double step_mm = std::max(options.step_mm, spacing_mm);
  if (!box.isEmpty()) {
    const Eigen::Vector3d s = box.sizes();
    const double area = 2 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
    step_mm = std::max(step_mm, std::sqrt(area / static_cast<double>(options.max_quads)));
  }
  Mesh mesh = model != nullptr && !model->faces.empty() ? *model : thinned_surface(scans, step_mm);
  ModelSurface out{MeshQuery(mesh), std::move(mesh), step_mm, {0, 0, 0}, {}, {}, {}, {}};

  std::vector<Eigen::Vector3f> thinned = thinned_for_hull(out.mesh.positions);
  std::vector<Eigen::Vector3d> extremes = hull_points(thinned);
  Mesh hull = convex_hull(extremes);
  out.faces = model_faces(scans, hull);
  if (const auto mirrored = mirrored_points(out.mesh, out.query, hull, extremes, out.faces);
      !mirrored.empty()) {
    for (const Eigen::Vector3d& p : mirrored) {
      thinned.push_back(p.cast<float>());
    }
    extremes = hull_points(thinned);
    hull = convex_hull(extremes);
  }
  out.corners_mm = extremes;
  Eigen::AlignedBox3d along_faces;
  for (const Eigen::Vector3d& p : extremes) {
    along_faces.extend(out.faces.model_from_faces.transpose() * p);
  }
  if (along_faces.isEmpty()) {
    return out;
  }
  out.center_mm = out.faces.model_from_faces * along_faces.center();

  std::vector<SurfacePatch> patches;
  const double patch_mm = std::sqrt(surface_area_mm2(hull) / static_cast<double>(options.patches));
  double carry = 0;
  for (const auto& f : hull.faces) {
    if (patch_mm > 0) {
      sample_face(extremes[f[0]], extremes[f[1]], extremes[f[2]], patch_mm, carry, patches);
    }
  }
  std::vector<std::uint8_t> seen(patches.size());
  parallel_for_each_index(
      patches.size(),
      [&](std::size_t i) { seen[i] = seen_from_outside(out.query, patches[i], step_mm) ? 1 : 0; }, 64);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    (seen[i] != 0 ? out.seen : out.unseen).push_back(patches[i]);
  }
  leave_out_air(scans, hull, out);
  return out;
}

}  // namespace dubsar
