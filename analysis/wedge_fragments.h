// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "analysis/wedge_measure.h"

namespace dubsar {

/// Rejects candidates that are a piece of another one: most of their vertices lie on the other's faces,
/// within its outline. So are the tail that a later wedge has cut off, and basins that noise has split. Of
/// two that are pieces of each other the larger stays. position: [V] of the mesh.
void reject_fragments(std::span<const Eigen::Vector3f> position, std::vector<WedgeCandidate>* candidates);

}  // namespace dubsar
