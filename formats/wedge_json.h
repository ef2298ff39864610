// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/wedge.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

/// One wedge by the keys of the contract "Wedges" (design.md): degrees and millimetres.
[[nodiscard]] OrderedJson wedge_json(const Wedge& wedge);
/// Adds what an analysis knows besides: both exit points, lengths, slopes, volume, sigmas, place in the text.
void add_measures(const Wedge& wedge, OrderedJson* json);
/// Reads either. What is absent follows from the contract's keys (both exit points, lengths, slopes against a
/// surface that is flat above the wedge, volume) or is NaN (bows, slopes of faces, sigmas).
[[nodiscard]] Wedge wedge_from(const JsonNode& node, double mm_per_unit);

}  // namespace dubsar
