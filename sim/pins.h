// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/pin_set.h"
#include "core/rigid_transform.h"
#include "sim/scanner.h"
#include "sim/scene.h"

namespace dubsar::sim {

struct PinOptions {
  int count = 15;
  double tip_diameter_mm = 1.0;
  double gap_min_mm = 1.0;  ///< between tip ball and clay
  double gap_max_mm = 2.0;
  double replace_sigma_mm = 0.3;  ///< per axis, each time the tablet is turned by hand
  std::uint64_t seed = 1;
};

/// Pins on arms whose tips point at places around the rim (seed 001, 3.2). They move with the tablet and are
/// put back, roughly, when it has been turned.
class PinStand {
 public:
  /// Labels 1 to count go round the rim anticlockwise as seen from the obverse.
  PinStand(const SimTablet& tablet, const MeshQuery& query, const PinOptions& options);

  /// The pins in the tablet frame at a placement; placement 0 is the first, undisturbed one.
  [[nodiscard]] std::vector<Pin> placed(int placement) const;
  [[nodiscard]] const PinOptions& options() const { return options_; }

 private:
  PinOptions options_;
  std::vector<Pin> pins_;
};

/// The pins that may stay for a scan: those that hide no clay from laser or camera and that do not reach into
/// the scene's support. The scene's own pins are ignored.
[[nodiscard]] std::vector<Pin> standing_pins(const std::vector<Pin>& pins, const Scene& scene,
                                             const TriangulationScanner& scanner,
                                             const RigidTransform& tablet_from_scanner);

/// True tip centres in the scanner frame.
[[nodiscard]] std::vector<PinTip> tips_in_scanner(const std::vector<Pin>& pins,
                                                  const RigidTransform& tablet_from_scanner);

/// Tips as an operator clicks them: off by up to max_error_mm.
[[nodiscard]] std::vector<PinTip> clicked_tips(const std::vector<PinTip>& true_tips, double max_error_mm,
                                               std::uint64_t seed);

}  // namespace dubsar::sim
