// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/basins.h"
#include "analysis/surface_fields.h"
#include "analysis/wedge_faces.h"
#include "analysis/wedge_judge.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/wedge.h"

namespace dubsar {

struct WedgeOptions {
  ExitDefinition exits = ExitDefinition::kSurface;
  bool classical_watershed = false;
  /// Basins smaller than this are flooded, in area and in depth; they follow the mesh's spacing upwards.
  double min_basin_mm2 = 0.04;
  double min_basin_depth_mm = 0.02;
  FaceOptions faces;
  JudgeOptions judge;
};

/// The wedges of a tablet.
struct WedgeSet {
  std::vector<Wedge> wedges;             ///< id = index
  std::vector<EvidenceValues> evidence;  ///< of each wedge
  std::vector<RejectedWedge> rejected;
  std::vector<std::int32_t> basin_of;  ///< [V] see Basins::label
  std::vector<std::int32_t> wedge_of;  ///< [V] wedge on whose faces the vertex lies, or -1
  std::vector<std::int8_t> face_of;    ///< [V] which face of it, 0 to 2, or -1
};

/// Watershed, faces, edges, measures and judgement (seed 000, 3.3 and 3.4). The same bytes for any number of
/// threads. A mesh without wedges gives an empty list. Errors: kCancelled.
[[nodiscard]] Result<WedgeSet> find_wedges(const Mesh& mesh, const VertexGraph& graph,
                                           const SurfaceFields& fields, const WedgeOptions& options,
                                           const JobContext& job, StageTimes* timings_s = nullptr);

}  // namespace dubsar
