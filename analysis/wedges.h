// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/basins.h"
#include "analysis/surface_fields.h"
#include "analysis/wedge_faces.h"
#include "analysis/wedge_judge.h"
#include "analysis/wedge_measure.h"
#include "core/job.h"
#include "core/known_wedge.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/wedge.h"
#include "core/wedge_correction.h"

namespace dubsar {

/// Raised whenever the same mesh gives other wedges, or other words of them: what was kept by another method
/// is measured anew. 2: edges are counted from the directional one; sigmas of slopes, and on coarse meshes
/// larger. 3: faces are fitted away from creases and rims. 4: bowls and cones are none, sigmas
/// follow what is missing of a wedge, each body of a mesh is measured alone. 5: depths are below the side
/// that a wedge is impressed in, sigmas follow how round its faces are and how far the surface turns above
/// it. 6: a line of one sign is a line above full ones too.
inline constexpr int kWedgeMethod = 6;

struct WedgeOptions {
  ExitDefinition exits = ExitDefinition::kSurface;
  bool classical_watershed = false;
  /// Basins smaller than this are flooded, in area and in depth; they follow the mesh's spacing upwards.
  double min_basin_mm2 = 0.04;
  double min_basin_depth_mm = 0.02;
  FaceOptions faces;
  JudgeOptions judge;
  /// What a person has said of them; made in this order once they are found.
  std::vector<WedgeCorrection> corrections;
  /// Whose ids are carried over (analysis/wedge_ids.h).
  EarlierWedges earlier;
};

/// What the mesh itself says, before anybody corrects it.
struct WedgeFindings {
  std::vector<WedgeCandidate> candidates;  ///< judged
  std::vector<std::int32_t> basin_of;      ///< [V] see Basins::label
  std::vector<float> area_mm2;             ///< [V] of the surface that the vertex stands for
  std::vector<std::uint8_t> is_noisy;      ///< of each body: is_noisy() (analysis/hollow_measure.h)
};

/// The wedges of a tablet.
struct WedgeSet {
  std::vector<Wedge> wedges;             ///< ids rise; those of former ones are missing
  std::vector<EvidenceValues> evidence;  ///< of each wedge
  std::vector<RejectedWedge> rejected;
  std::vector<std::int32_t> basin_of;  ///< [V] see Basins::label
  std::vector<std::int32_t> wedge_of;  ///< [V] wedge on whose faces the vertex lies, or -1
  std::vector<std::int8_t> face_of;    ///< [V] which face of it, 0 to 2, or -1
  std::vector<LostCorrection> lost;    ///< corrections that could not be made
  std::vector<KnownWedge> former;      ///< ids that are not to be given again, but to the same wedge
  std::size_t found_again = 0;         ///< how many of the earlier ones lie where they lay
  bool forgot_earlier = false;         ///< they were taken for another tablet's
};

/// Watershed, faces, edges, measures and judgement (seed 000, 3.3 and 3.4). The same bytes for any number of
/// threads. A mesh without wedges gives an empty list. Errors: kCancelled. The same as find_candidates() and
/// settle_wedges() with options.corrections.
[[nodiscard]] Result<WedgeSet> find_wedges(const Mesh& mesh, const VertexGraph& graph,
                                           const SurfaceFields& fields, const WedgeOptions& options,
                                           const JobContext& job, StageTimes* timings_s = nullptr);

/// Each body of the mesh by itself, as if it were alone.
[[nodiscard]] Result<WedgeFindings> find_candidates(const Mesh& mesh, const VertexGraph& graph,
                                                    const SurfaceFields& fields, const WedgeOptions& options,
                                                    const JobContext& job, StageTimes* timings_s = nullptr);
/// The wedges among the findings, corrected as `options` say, under their ids (analysis/wedge_ids.h).
/// Arguments as for find_candidates().
[[nodiscard]] WedgeSet settle_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                                     const WedgeOptions& options, const WedgeFindings& findings);

}  // namespace dubsar
