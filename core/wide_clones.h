// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

/// DUBSAR_WIDE_CLONES before a function: it is built a second time for processors that work on eight floats
/// at once (AVX2), and the program takes the one that fits when it starts. The results are the same bytes:
/// nothing is fused (-ffp-contract=off) and nothing is summed in another order. Sanitizers do not bear
/// functions that are chosen before they have started.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define DUBSAR_WIDE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define DUBSAR_WIDE_CLONES
#endif
