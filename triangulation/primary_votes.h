// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/job.h"
#include "triangulation/owned_scan.h"

namespace dubsar {

/// By scan and node: 1 where the scan would be primary, -1 where another would, 0 where it has no sample. The
/// best score decides (of equals the lower position), a little in favour of who has the places around, so
/// that patches are large and seams few: else a wedge's flanks, and noise where two scans see a place alike,
/// part the surface into hundreds of them. Looks at surfaces and pairs only. Empty when cancelled.
[[nodiscard]] std::vector<std::vector<float>> primary_votes(const std::vector<OwnedScan>& scans,
                                                            const JobContext& job = {});

/// 1 for the samples around which a scan with these votes would be primary. Those of which fewer than `least`
/// lie beside each other are none: no patch would come of them.
[[nodiscard]] std::vector<std::uint8_t> wanted_samples(const StitchSurface& surface,
                                                       std::span<const float> votes, int least);

}  // namespace dubsar
