// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/scan_copies.h"
#include "triangulation/fusion.h"
#include "triangulation/pairing.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

/// A scan's id, and which of its stage's passes: each is stitched as if it were a scan of its own.
using PassKey = std::pair<int, int>;

struct Entry {
  StitchSurface surface;
  std::map<PassKey, Pairs> pairs;  ///< by the other pass; those without a pair hold no matches
  std::vector<std::uint8_t> wanted;
  FusedSamples fused;
  /// By node: 1 where pairs have come or gone that wanted and fused do not know of yet; empty: nowhere.
  std::vector<std::uint8_t> changed;

  void mark_changed(const Pairs& at) {
    changed.resize(at.match.size(), 0);
    for (std::size_t node = 0; node < changed.size(); ++node) {
      changed[node] |= at.match[node] >= 0 ? 1 : 0;
    }
  }
};

/// What is known of a scan beside its entries.
struct Held {
  std::optional<SampleDigest> samples;  ///< nothing where it has none
  /// Its passes, while a scan with a lower id and the same samples takes part in its place.
  std::vector<StitchSurface> waiting;

  [[nodiscard]] bool waits() const { return !waiting.empty(); }
};

/// The samples that it wants and that have not been averaged yet, node by node.
[[nodiscard]] std::vector<std::uint32_t> unfused(const Entry& entry);

}  // namespace dubsar
