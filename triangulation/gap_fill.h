// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "triangulation/front.h"
#include "triangulation/seam_closer.h"

namespace dubsar {

struct GapFillOptions {
  /// Openings up to this far across, × µ, are gaps of a few samples and get filled; wider ones are clay that
  /// was not seen and stay open.
  double most_width_factor = 8.0;
  /// Wider ones, up to this, where clay was seen all over the opening and only its scans do not agree.
  double most_seen_width_factor = 14.0;
  /// Whether some scan has a sample within radius_mm of a place (model frame); none: nothing was seen.
  std::function<bool(const Eigen::Vector3f& p_mm, float radius_mm)> seen;
  /// A crack may be longer than that when it is narrower than this, × µ (twice its area over its length).
  double crack_width_factor = 1.0;
  /// The same for one where clay was seen all over: no scan has enough there for a patch of its own.
  double seen_crack_width_factor = 8.0;
};

/// Width of an opening: the largest distance between two of its vertices, mm (for long ones the diagonal of
/// its box).
[[nodiscard]] double opening_diameter_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening);

/// True for what GapFillOptions calls a gap or a crack.
[[nodiscard]] bool is_gap(const Sheet& sheet, const std::vector<std::uint32_t>& opening,
                          const GapFillOptions& options);

/// How far from a vertex of a gap lies what is cleared there, or looked at to close it.
[[nodiscard]] float gap_reach_mm(float spacing_mm, const SeamOptions& seam);

/// Whether a gap can be closed, and what lies around it cleared, within the room of its sheet.
[[nodiscard]] bool has_room(const Sheet& sheet, const std::vector<std::uint32_t>& opening,
                            const SeamOptions& seam);

/// Puts interpolated vertices into an opening that is wider than its edges can bridge: points of a hexagonal
/// raster of spacing µ in the opening's mean plane, at heights interpolated from the opening's vertices by
/// mean value coordinates (Floater 2003). Returns how many were added; they are the last of the sheet.
std::size_t interpolate_vertices(Front& front, const std::vector<std::uint32_t>& opening);

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
