// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/pin_set.h"
#include "core/scan_pose.h"

namespace dubsar {

/// Labels from here on are places on the rim that the operator knows again; below, pins by number.
inline constexpr int kFirstRimLabel = 101;

[[nodiscard]] inline bool is_rim_label(int label) {
  return label >= kFirstRimLabel;
}
/// "7" of a pin, "C" of a place on the rim.
[[nodiscard]] std::string pin_name(int label);

/// Where a labelled pin's tip, or a labelled place on the rim, stands on the model.
struct ShownPin {
  int label = 0;
  Eigen::Vector3d position_mm{0, 0, 0};  ///< model frame
  std::vector<int> scans;                ///< that show it there, in order
};

/// Of all registered scans. Pins are only approximately put back when the tablet is turned (seed 001, 3.2):
/// what scans show within `same_mm` of each other is one place, in their middle; a label may have several.
[[nodiscard]] std::vector<ShownPin> shown_pins(const PinSet& pins, const std::vector<ScanPose>& poses,
                                               double same_mm = 1.0);

}  // namespace dubsar
