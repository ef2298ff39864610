// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "bench/support/pair_cases.h"

namespace dubsar::bench {

/// What the product does with a rough start (align_near.h). Its preparation of a scan is what registration
/// keeps of one.
[[nodiscard]] PairMethod dubsar_method(const std::vector<PublishedScan>& scans);

}  // namespace dubsar::bench
