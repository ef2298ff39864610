// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "registration/model_fit.h"

namespace dubsar {

/// How much larger a scan is than the others say, along two axes of its scanner; 0.01 is one per cent. Depth
/// is not told: a face that is seen from above hardly holds it.
struct ScanStretch {
  double along_line = 0;    ///< the laser's line, x
  double along_motion = 0;  ///< the stage's, y
  double shear = 0;         ///< x that is added for each y: lines drift sideways, or the axes are not square
  double sigma = 0;         ///< of the worse determined length, if samples were independent
  double shear_sigma = 0;   ///< likewise; of the fit with a shear, also where none is told
  /// The scan's samples with both taken off, and where they then lie: for what else may be wrong.
  std::unique_ptr<ScanSurface> mended;
  RigidTransform model_from_mended;

  /// Beyond what right scans were seen to show, and certain.
  [[nodiscard]] bool has_lengths_off() const;
  [[nodiscard]] bool is_sheared() const;
  [[nodiscard]] bool is_off() const { return has_lengths_off() || is_sheared(); }
  /// The shear is what is to be told, not the lengths.
  [[nodiscard]] bool is_rather_sheared() const;
  /// How much of that.
  [[nodiscard]] double largest() const;
  /// Nothing is off here, and enough is shared to tell that of what the other one accuses the scan of.
  [[nodiscard]] bool acquits_of(const ScanStretch& accused) const;
};

/// Fits the scan to the others with its lengths left free: a stage whose step is not what it says, or a scan
/// of another calibration, is stretched against the rest, and a rigid fit hides half of it. `fit` is that of
/// the whole scan in `model`. Nothing where too little is shared.
[[nodiscard]] std::optional<ScanStretch> find_stretch(const ScanSurface& scan,
                                                      std::span<const ModelScan> model, const ModelFit& fit);

/// False where a part of the samples shows that find_stretch() would tell nothing, at a quarter of its cost.
[[nodiscard]] bool may_be_stretched(const ScanSurface& scan, std::span<const ModelScan> model,
                                    const ModelFit& fit);

/// For people: what is off, and the mend.
[[nodiscard]] std::string reason_of(const ScanStretch& stretch);

}  // namespace dubsar
