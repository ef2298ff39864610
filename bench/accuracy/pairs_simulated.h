// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

namespace dubsar::bench {

/// Measures pairs of scans of simulated tablets (pair_fit.h) from close to the truth and prints, for each
/// kind of tablet, spacing and noise, how far off they are and whether their covariances are what they claim:
/// the mean of the normalised squared error per degree of freedom, 1 when they are.
void print_simulated_pairs(int tablets, std::uint64_t first_seed);

}  // namespace dubsar::bench
