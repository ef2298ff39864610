// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "triangulation/fusion.h"
#include "triangulation/pairing.h"
#include "triangulation/pose_step.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

/// A scan's id, and which of its stage's passes: each is stitched as if it were a scan of its own.
using PassKey = std::pair<int, int>;

struct Entry {
  StitchSurface surface;
  std::map<PassKey, Pairs> pairs;     ///< by the other pass; those without a pair hold no matches
  std::map<PassKey, PoseStep> steps;  ///< to passes that come later, of other scans, by the same keys
  std::vector<float> votes;           ///< by node, that `wanted` is of
  std::vector<std::uint8_t> wanted;
  FusedSamples fused;
  /// By node: 1 where pairs have come or gone that wanted and fused do not know of yet; empty: nowhere.
  std::vector<std::uint8_t> changed;

  void mark_all_changed() { changed.assign(surface.lattice.size(), 1); }
  void mark_changed(const Pairs& at) {
    changed.resize(at.match.size(), 0);
    for (std::size_t node = 0; node < changed.size(); ++node) {
      changed[node] |= at.match[node] >= 0 ? 1 : 0;
    }
  }
};

/// What is known of a scan beside its entries.
struct Held {
  /// Its passes, while a scan with its samples takes part in its place.
  std::vector<StitchSurface> waiting;

  [[nodiscard]] bool waits() const { return !waiting.empty(); }
};

struct FoundPairs {
  PassKey other;
  Pairs there, back;
  PoseStep step;  ///< from the lower key to the higher; none between passes of one scan
};
/// Of two passes, the same whichever way round; nothing where they do not touch. Of a job that is cancelled
/// they are no good.
[[nodiscard]] std::optional<FoundPairs> pairs_between(const PassKey& key, const StitchSurface& surface,
                                                      const PassKey& other_key, const StitchSurface& other,
                                                      const PairingOptions& options, const JobContext& job);

using Entries = std::map<PassKey, Entry>;

/// What the steps between scans say of their poses' errors comes into their surfaces; where that changes
/// something, averages are old. False when cancelled: then the surfaces are as they were, and it has to be
/// done again.
[[nodiscard]] bool weigh_places(Entries& entries, const JobContext& job);

/// The scans of which no pass has a triangle; by id.
[[nodiscard]] std::vector<int> without_surface(const Entries& entries);

/// The scans of which a motion is known that takes them to where the others have them, and how far it does:
/// RMS over the surface of what shows along its normals, × √3, mm; by id.
[[nodiscard]] std::map<int, double> moved_mm(const Entries& entries);

/// The samples that it wants and that have not been averaged yet, node by node.
[[nodiscard]] std::vector<std::uint32_t> unfused(const Entry& entry);

}  // namespace dubsar
