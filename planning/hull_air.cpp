// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/hull_air.h"

#include <cstdint>
#include <vector>

#include "core/mesh_query.h"
#include "core/parallel.h"
#include "planning/free_space.h"
#include "planning/patch_rays.h"

namespace dubsar {

namespace {

/// Whether a ray that meets no surface leads through nothing but air, from where it enters the hull to where
/// it leaves it. Lines of sight leave single cells out.
bool leads_through_air(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& along, const MeshQuery& hull,
                       const FreeSpace& air) {
  const auto ray = along.cast<float>();
  const auto into = hull.first_hit(from_mm.cast<float>(), ray, 0.0F, static_cast<float>(kFarFromPatchMm));
  if (!into) {
    return true;  // beside it
  }
  const double enters_mm = into->distance_mm;
  const auto out_of =
      hull.first_hit(from_mm.cast<float>(), ray, static_cast<float>(enters_mm + 1e-3 * air.cell_mm()),
                     static_cast<float>(kFarFromPatchMm));
  const double leaves_mm = out_of ? out_of->distance_mm : enters_mm;
  double dark_mm = 0;
  const double most_dark_mm = 2.5 * air.cell_mm();
  const double step_mm = 0.5 * air.cell_mm();
  for (double at = enters_mm + 0.5 * step_mm; at < leaves_mm && dark_mm <= most_dark_mm; at += step_mm) {
    dark_mm = air.was_looked_through(from_mm + at * along) ? 0 : dark_mm + step_mm;
  }
  return dark_mm <= most_dark_mm;
}

/// A patch where the hull spans a hollow that somebody looked through: no surface is missing there.
bool lies_over_air(const SurfacePatch& patch, const ModelSurface& surface, const MeshQuery& hull,
                   const FreeSpace& air) {
  constexpr int kEnough = 7;
  int fine = 0;
  for (const Eigen::Vector3d& from : patch_ray_starts(patch, surface.step_mm)) {
    const auto hit = surface.query.first_hit(from.cast<float>(), -patch.normal.cast<float>(), 0.0F,
                                             static_cast<float>(kFarFromPatchMm));
    fine += hit ? (hit->normal.dot(patch.normal.cast<float>()) > 0 ? 1 : 0)
                : (leads_through_air(from, -patch.normal, hull, air) ? 1 : 0);
  }
  return fine >= kEnough;
}

}  // namespace

void leave_out_air(std::span<const PlacedScan> scans, const Mesh& hull, ModelSurface& surface) {
  if (surface.unseen.empty()) {
    return;
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : surface.corners_mm) {
    box.extend(p);
  }
  const FreeSpace air(scans, box, 4.0 * surface.step_mm);
  const MeshQuery hull_query(hull);
  std::vector<std::uint8_t> gone(surface.unseen.size());
  parallel_for_each_index(
      gone.size(),
      [&](std::size_t i) { gone[i] = lies_over_air(surface.unseen[i], surface, hull_query, air) ? 1 : 0; },
      64);
  std::size_t i = 0;
  std::erase_if(surface.unseen, [&](const SurfacePatch&) { return gone[i++] != 0; });
}

}  // namespace dubsar
