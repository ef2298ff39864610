// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "core/job.h"
#include "triangulation/draft.h"

namespace dubsar {

/// Flips the longest edge of faces with an angle below 10° where that gives better ones and hardly moves the
/// surface; where that edge is open, such a face goes. Looks at the faces from first_face on: within patches
/// faces are as their grids have them. Returns how many slivers went; of a job that is cancelled, not all.
std::size_t remove_slivers(Draft& draft, std::size_t first_face, const JobContext& job = {});

}  // namespace dubsar
