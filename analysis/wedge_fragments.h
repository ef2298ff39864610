// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "analysis/wedge_judge.h"
#include "analysis/wedge_measure.h"

namespace dubsar {

/// judge_wedges(), but for candidates that are a piece of another wedge, which are rejected: most of their
/// vertices lie on the other's faces, within its outline. So are the tail that a later wedge has cut off, and
/// basins that noise has split. Of two that are pieces of each other the larger stays. What is judged to be
/// no wedge has no pieces: those are judged then, with all the others beside them. position: [V] of the mesh.
void judge_wholes(const JudgeOptions& options, std::span<const Eigen::Vector3f> position,
                  std::vector<WedgeCandidate>* candidates);

}  // namespace dubsar
