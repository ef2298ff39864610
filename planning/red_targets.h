// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/placed_scan.h"
#include "core/red_map.h"
#include "planning/model_surface.h"
#include "planning/vain_look.h"

namespace dubsar {

/// A small piece of what is still missing: red samples of one cell of space, or a patch of surface that
/// nobody has seen.
struct RedTarget {
  Eigen::Vector3d position_mm{0, 0, 0};  ///< model frame
  Eigen::Vector3d normal{0, 0, 1};       ///< out of the clay: of the surface that is supposed to lie there
  /// Mean of the red samples themselves; position_mm lies in the gap beside them.
  Eigen::Vector3d sample_mm{0, 0, 0};
  double area_mm2 = 0;
  /// Of RedTargets::cell_mm: how far around it things hang together, by the spacing of the scans there.
  double cell_share = 1;
  bool unseen = false;  ///< with no samples of its own: a patch of the closing surface, or a rim
  /// Red, though scans enough looked straight at it in the open, each from elsewhere: a person has to look.
  bool no_signal = false;
  bool given_up = false;        ///< no further view is planned for it
  bool rim = false;             ///< where the well-sampled surface ends, and no red sample marks it
  std::vector<VainLook> tried;  ///< scans that might have seen it and did not
  std::vector<VainLook>
      perhaps;  ///< likewise, if their fields reach as far as is supposed of those of new views
  RegionState state = RegionState::kRed;
  Excuse excuse = Excuse::kNone;
  std::string reason;  ///< of the excuse; of a red one, why no view will clear it
  /// Where interpolation puts the missing surface, of targets that are unneeded for that.
  std::optional<Eigen::Vector3d> interpolated_mm;

  void excuse_as(Excuse why, std::string because) {
    state = RegionState::kExcused;
    excuse = why;
    reason = std::move(because);
  }
  /// Nothing is missing where it is.
  void excuse_as_stray() {
    excuse_as(Excuse::kUnneeded, "stray return: it hangs apart from the surface, which is closed there");
    area_mm2 = 0;
  }
};

/// Where the target of each red sample is.
struct RedSampleRef {
  std::uint32_t scan = 0;    ///< position in the span of scans
  std::uint32_t sample = 0;  ///< index in its grid
  std::uint32_t target = 0;
};

struct RedTargets {
  std::vector<RedTarget> targets;
  std::vector<RedSampleRef> samples;  ///< by target, then scan, then sample
  /// Edge of the cells that red samples were gathered in: of the coarsest scan, the greatest.
  double cell_mm = 0;
  double slits_mm2 = 0;  ///< of those that are unneeded as slits or pits: all together have one budget
};

struct RedTargetOptions {
  double cell_mm = 0.3;            ///< at least 3 µ of the scan; grown until there are few enough targets
  std::size_t max_targets = 4000;  ///< of red samples
  double longest_gap_mm =
      5.0;  ///< a gap counts for no more than this: beyond lies another part of the object
};

/// Gathers red samples and unseen patches. The area of a red sample is half of each gap to the next sample
/// along its row and its column, times µ: over both rims of a hole that adds up to the hole. Its normal is
/// that of the surface which would close the gap. Where several scans are red at one place the largest area
/// counts.
[[nodiscard]] RedTargets red_targets(std::span<const PlacedScan> scans, const ModelSurface& surface,
                                     const RedTargetOptions& options = {});

/// Removes small groups of unseen patches (below 10 mm²) that have less than a quarter of the red samples
/// which the border of such a hole would have: they lie over slits of the thinned surface. Larger ones always
/// stay, unless what was sampled is a closed surface: then nothing is missing behind those that no red sample
/// and no rim borders. Only red samples are a border, excused ones are not.
void drop_unbordered_patches(std::span<const PlacedScan> scans, bool is_closed, RedTargets& red);

}  // namespace dubsar
