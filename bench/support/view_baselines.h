// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "bench/support/closed_loop.h"

namespace dubsar::bench {

/// A greedy set cover that knows the true surface: of the rig's candidates (from how the tablet truly lies,
/// with no error of the hand) always the one that sees most of what no scan has sampled, by rays against the
/// truth, among those that overlap what was sampled by `least_overlap`. Each pick is then really scanned.
/// Returns after how many scans the share of truth points is reached, or max_scans.
int greedy_cover(const LoopOptions& options, double share, double least_overlap, int max_scans);

/// Eight steps round at a tilt of 45°, on each of the six sides in turn, until the red map is conclusive.
int uniform_turntable(const LoopOptions& options, int max_scans);

/// The scanner looks straight at the largest red region, never twice from the same candidate, until
/// the red map is conclusive.
int boundary_following(const LoopOptions& options, int max_scans);

}  // namespace dubsar::bench
