// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "registration/icp_information.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// Where on a scan a fit found its pairs: over patches of the scan's rows and columns, the root of the share
/// of the pairs that lie there. Empty where it is not known.
using Footprint = std::vector<float>;

/// Of the samples that were sent, terms[k] that of samples[k].
[[nodiscard]] Footprint footprint(std::span<const SurfaceSample> samples, std::span<const PullTerm> terms);

/// How much of a scan's noise two fits of it have in common, as a correlation: 1 where they use the same part
/// of it (and where that is not known), 0 where they use two ends of it.
[[nodiscard]] double in_common(const Footprint& a, const Footprint& b);

}  // namespace dubsar
