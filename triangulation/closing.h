// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "core/job.h"
#include "triangulation/count_work.h"
#include "triangulation/draft.h"
#include "triangulation/gap_fill.h"
#include "triangulation/seam_closer.h"

namespace dubsar {

struct ClosingOptions {
  SeamOptions seam;
  GapFillOptions gap;
  double tile_spacings = 300.0;  ///< × the coarsest µ: edge of the tiles that are closed side by side
  std::size_t least_tiled_vertices = 50000;  ///< near what is open; fewer are one piece of work
  CountWork counted{};                       ///< of the search for faces that cut each other
};

/// Closes the seams between the patches of a draft, and its gaps. Where patches touch by a corner only, the
/// largest keeps it; around a gap that cannot be closed faces go and another try is made. What comes of it as
/// slivers is flipped where that helps. A job that is cancelled leaves the draft half done.
void close_patches(Draft& draft, const ClosingOptions& options, const JobContext& job);

/// Takes out faces that cut through each other, later with those around them, and closes the place anew; what
/// still cuts at the end goes for good. A job that is cancelled leaves the draft half done.
void repair_self_intersections(Draft& draft, const ClosingOptions& options, const JobContext& job);

}  // namespace dubsar
