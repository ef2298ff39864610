// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/wedge.h"

namespace dubsar::sim {

/// How a tablet has fared; each from 0 (none) to 1 (badly).
struct DamageOptions {
  double fracture = 0.3;  ///< corners and edges broken off
  double erosion = 0.3;   ///< patches worn smooth
  double dirt = 0.3;      ///< wedges filled
  double cracks = 0.3;
  double holes = 0;  ///< firing holes: narrow, deep, their walls and floors mostly out of any scanner's sight
  // Of every hole and every crack instead of what is drawn for each; 0: drawn.
  double hole_radius_mm = 0;
  double hole_depth_mm = 0;
  double crack_depth_mm = 0;

  [[nodiscard]] static DamageOptions none() { return {0, 0, 0, 0, 0, 0, 0, 0}; }
};

struct TabletOptions {
  std::uint64_t seed = 1;
  Eigen::Vector3d size_mm{50, 40, 20};  ///< width x, height y, thickness z; each 5 to 300
  double spacing_mm = 0.1;              ///< mean edge length of the mesh
  double text_density = 1.0;            ///< share of the room for text that is written on; 0: blank
  double line_height_mm = 0;            ///< 0: chosen from the size
  bool text_on_edges = true;
  double unevenness_mm = 0.15;  ///< of the hand-made body
  double grain_um = 12;         ///< amplitude of the clay's grain
  double seal_um = 20;          ///< relief of the rolled seal; 0: none
  DamageOptions damage;
};

/// What made the surface at a vertex.
enum class SurfaceKind : std::uint8_t { kBody, kSeal, kWedge, kFracture, kErosion, kDirt, kCrack, kHole };

/// A tablet with all that is true about it. Its frame: origin at the centre of the body, obverse +z, top edge
/// +y, right edge +x.
struct SimTablet {
  Mesh mesh;                           ///< watertight, oriented, with normals and colours
  std::vector<float> albedo;           ///< [V], in [0,1]
  std::vector<SurfaceKind> kinds;      ///< [V]
  std::vector<std::int32_t> wedge_of;  ///< [V], id of the wedge whose face the vertex lies on, or -1
  std::vector<Wedge> wedges;           ///< in writing order, id = index; `intact` and `vertex_count` filled
};

/// A tablet of which only a mesh is known, as read from a file: albedo from the red channel of its colours
/// (which make_tablet() fills), else even; normals computed where they are missing. The mesh is taken as it
/// lies: its origin should be its centre.
[[nodiscard]] SimTablet tablet_from_mesh(Mesh mesh, float albedo = 0.5F);

/// Makes a tablet; the same options give the same bytes on every machine and for any number of threads.
/// Errors: kUsage for a size or spacing that cannot be meshed, kCancelled.
[[nodiscard]] Result<SimTablet> make_tablet(const TabletOptions& options, JobContext& job);

}  // namespace dubsar::sim
