// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/pin_advice.h"

namespace dubsar {

/// The pins of a scan whose pose is sure.
struct ScanPinsInModel {
  int id = 0;
  std::vector<SeenPin> tips;  ///< scanner frame
  RigidTransform model_from_scanner;
  /// Another one of them that has all samples of this one: of a pin that both show they are one witness.
  std::optional<int> part_of = std::nullopt;
};

/// Labels that the poses contradict: a pin was put elsewhere between two scans, or has another's label. Where
/// scans disagree about a label, those that most others agree with are right; of equals the first. A part of
/// a scan is no second word beside it. For each scan one line for the operator, on the pin that is farthest
/// off; empty where nothing is.
[[nodiscard]] std::vector<std::string> contradicted_labels(std::span<const ScanPinsInModel> scans,
                                                           const PinAdviceOptions& options = {});

/// For the operator: the scan `other_id` shows the pin elsewhere.
[[nodiscard]] std::string moved_pin(const std::string& pin, int other_id, double off_mm);

}  // namespace dubsar
