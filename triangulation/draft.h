// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "triangulation/half_edges.h"
#include "triangulation/owned_scan.h"

namespace dubsar {

/// The mesh while it is put together: the patches that scans keep, scan by scan, then what closes the seams
/// between them. A face {v, v, v} has been taken away; it stays so that the numbers of the others do.
struct Draft {
  Mesh mesh;                                ///< normals as measured, not from the faces
  std::vector<std::uint32_t> first_vertex;  ///< [scans + 1] of each patch
  std::vector<std::uint32_t> first_face;    ///< [scans + 1]
  std::vector<float> patch_spacing_mm;      ///< [scans]
  std::vector<float> added_spacing_mm;      ///< of the vertices after the last patch
  /// [V] kAtRim at the rim of a patch, 1 within a few samples of it, and for what was added; kLoose for what
  /// came without a face, as long as none that it got was taken away: elsewhere faces close around the vertex
  /// as those of a grid do.
  std::vector<std::uint8_t> near_rim;

  [[nodiscard]] float spacing_mm(std::uint32_t vertex) const;
  static constexpr std::uint8_t kAtRim = 2;
  static constexpr std::uint8_t kLoose = 3;
  /// The patch (1 for the first) within which a face lies, away from the rim; 0: none. Faces of one patch all
  /// look at the scanner that they come from, each at a place of its own: they cannot cut each other. That
  /// holds where whole fans of grid triangles were checked; at rims and beside bridged drop-outs it may not.
  [[nodiscard]] std::uint32_t patch_of_face(std::size_t face) const;
};

[[nodiscard]] inline bool is_gone(const Triangle& f) {
  return f[0] == f[1];
}

/// The patches that assign_owners() left: vertices are the kept samples at their averaged places, faces their
/// triangles, and two more where a grid lacks one lone sample. Loose samples are vertices without a face.
/// Each has the colour that its own scan saw: scans are lit from elsewhere each, and averages of such colours
/// are none. Of a job that is cancelled some are not laid, and the draft is no good.
[[nodiscard]] Draft lay_patches(const std::vector<OwnedScan>& scans, const JobContext& job = {});

/// What closed seams and gaps takes its colour from what lies round it. After that, no vertex may be added
/// but as a copy of one.
void colour_added(Draft& draft, const JobContext& job = {});

}  // namespace dubsar
