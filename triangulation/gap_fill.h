// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "triangulation/front.h"
#include "triangulation/loose_vertices.h"
#include "triangulation/seam_closer.h"

namespace dubsar {

struct GapFillOptions {
  /// Openings up to this far across, × µ, may be gaps of a few samples that get filled; wider ones are clay
  /// that was not seen and stay open.
  double most_width_factor = 8.0;
  /// Wider ones, up to this, where scans saw clay all over the opening and only do not agree where it lies.
  double most_seen_width_factor = 14.0;
  /// The nearest sample of each scan that has one within radius_mm of a place, model frame; may leave some
  /// out, as long as of those beside each other there are others. None: nothing was seen.
  std::function<std::vector<Eigen::Vector3f>(const Eigen::Vector3f& p_mm, float radius_mm)> samples_near;
  /// A crack may be longer than that when it is narrower than this, × µ (twice its area over its length).
  double crack_width_factor = 1.0;
  /// The same for one where clay was seen all over: no scan has enough there for a patch of its own.
  double seen_crack_width_factor = 8.0;
  /// Of those up to most_width_factor none that holds a disc of this diameter, × µ, no sample of any scan by
  /// the middle of it, and sparse vertices around it: the red map has a hole there. In 2 × 2 missing samples
  /// the widest disc has 3.16 µ, in 3 × 3 it has 4.
  double bare_disc_factor = 3.6;
};

/// Width of an opening: the largest distance between two of its vertices, mm (for long ones the diagonal of
/// its box).
[[nodiscard]] double opening_diameter_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening);

/// True for what GapFillOptions calls a gap or a crack. `loose`: of the sheet.
[[nodiscard]] bool is_gap(const Sheet& sheet, const std::vector<std::uint32_t>& opening,
                          const LooseVertices& loose, const GapFillOptions& options);

/// How far from a vertex of a gap lies what is cleared there, or looked at to close it.
[[nodiscard]] float gap_reach_mm(float spacing_mm, const SeamOptions& seam);

/// Whether a gap can be closed, and what lies around it cleared, within the room of its sheet.
[[nodiscard]] bool has_room(const Sheet& sheet, const std::vector<std::uint32_t>& opening,
                            const SeamOptions& seam);

/// Puts vertices into an opening that is wider than its edges can bridge: the loose ones that lie in it, the
/// surest of those closer to each other than 0.6 µ; and, no nearer to any of them, nor to the rim,
/// interpolated ones: points of a hexagonal raster of spacing µ in the opening's mean plane, at heights
/// between the opening's vertices, drawn to the loose ones. Returns how many of these were added; they are
/// the last of the sheet.
std::size_t place_vertices(Front& front, const std::vector<std::uint32_t>& opening,
                           const LooseVertices& loose);

/// Closes a small opening by cutting ears, best shaped first, whatever lies near; refuses faces that would
/// turn over or use a half-edge twice. Returns the faces added.
std::size_t cut_ears(Front& front, const std::vector<std::uint32_t>& opening);

/// Closes every gap and crack of the front that has room. Vertices from `first_interpolated` on are
/// interpolated. Of a job that is cancelled some stay open.
struct GapFillResult {
  std::size_t first_interpolated = 0;
  std::size_t faces = 0;
};
GapFillResult fill_gaps(Front& front, const SeamOptions& seam, const GapFillOptions& options,
                        const JobContext& job = {});

}  // namespace dubsar
