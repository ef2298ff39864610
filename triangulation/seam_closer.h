// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <vector>

#include "core/job.h"
#include "triangulation/front.h"

namespace dubsar {

struct SeamOptions {
  double most_edge_factor = 2.6;      ///< × the coarser µ: longest new edge across a seam
  double most_gap_edge_factor = 4.0;  ///< the same where a small opening is closed
  double least_angle_rad = 0.21;      ///< 12°, where there is a choice
  double min_normal_cos = 0.4;        ///< the mean normal of a face's vertices and its own
  double min_crease_cos = 0.4;        ///< normals of an edge and of what it is joined to
};

/// Joins facing edges of the front across narrow seams: triangles between an open edge and a vertex of the
/// front, the Delaunay choice (largest angle at the third corner) in the local tangent plane, best shaped
/// first. A triangle is refused if it would cross an open edge, hold a vertex of the front, turn away from
/// the measured normals, or use a half-edge twice. Returns the faces added.
std::size_t close_seams(Front& front, const SeamOptions& options, const JobContext& job = {});

/// Open edges at which close_seams() had no room to choose.
[[nodiscard]] std::vector<Front::Edge> edges_without_room(const Front& front, const SeamOptions& options);

/// The same for the given openings only (walks from Front::openings()), with angles down to least_angle_rad
/// and longer edges.
std::size_t close_openings(Front& front, const std::vector<std::vector<std::uint32_t>>& openings,
                           double least_angle_rad, const SeamOptions& options, const JobContext& job = {});

}  // namespace dubsar
