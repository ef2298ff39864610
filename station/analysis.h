// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/surface_fields.h"
#include "analysis/text_frame.h"
#include "analysis/wedges.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "formats/wedges_json.h"

namespace dubsar {

struct AnalysisOptions {
  SurfaceFieldOptions fields;
  WedgeOptions wedges;
};

/// What the analysis of one mesh gives.
struct Analysis {
  VertexGraph graph;
  SurfaceFields fields;
  WedgeFindings findings;
  WedgeSet set;
  TextFrame text;
  StageTimes timings_s;  ///< in the order of the work
};

/// All stages on a mesh in millimetres: fields, watershed, wedges, their place in the text. Errors: kBadInput
/// for a mesh without a surface, kCancelled.
[[nodiscard]] Result<Analysis> analyze_mesh(const Mesh& mesh, const AnalysisOptions& options,
                                            const JobContext& job);

/// Makes the set and its places in the text anew with these corrections, from what the analysis has found;
/// corrections that cannot be made are in set.lost.
void correct_analysis(const Mesh& mesh, const AnalysisOptions& options, Analysis* analysis);

/// A line of the log for each correction that could not be made.
void warn_of_lost(const Analysis& analysis, const std::string& where);

/// wedges.json of it; the wedges themselves are taken out of `analysis`.
[[nodiscard]] WedgeFile wedge_file(std::string mesh_name, const AnalysisOptions& options,
                                   const Analysis& analysis);

/// The mesh with each wedge in a colour of its own, faces shaded apart, rejected basins grey-blue, and the
/// reliability that the analysis found.
[[nodiscard]] Mesh annotated_mesh(const Mesh& mesh, const Analysis& analysis);

}  // namespace dubsar
