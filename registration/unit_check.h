// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

namespace dubsar {

/// Size of a scan, for telling units apart.
struct ScanSize {
  double scale_mm = 0;    ///< surface_scale_mm()
  double spacing_mm = 0;  ///< µ
};

/// Why a scan cannot be what it says whatever the others are: too small or too large for anything that is
/// scanned; with how far its unit is from the one that was said, and the mend. Empty when its size is
/// possible.
[[nodiscard]] std::string impossible_size(const ScanSize& scan, double least_mm, double most_mm);

/// Samples as far apart, as one scanner sets them: then no unit stands between the two, however little of the
/// object one of them shows. False where a spacing is not known.
[[nodiscard]] bool same_spacing(const ScanSize& a, const ScanSize& b);

/// Whether the two may be in one unit: samples as far apart, or sizes that differ by no more than this.
[[nodiscard]] bool sizes_agree(const ScanSize& a, const ScanSize& b, double most_ratio);

/// Of a scan whose size differs from that of the scans before it by more than anything but a unit explains.
[[nodiscard]] std::string other_unit(const ScanSize& scan, const ScanSize& before);

/// What a scan that found no place may suffer from: both its size and its spacing differ from those of the
/// scans before it by the factor between two units (inches, centimetres). Empty when they do not. No proof: a
/// detail taken with another lens is smaller and finer too.
[[nodiscard]] std::string perhaps_other_unit(const ScanSize& scan, const ScanSize& before);

}  // namespace dubsar
