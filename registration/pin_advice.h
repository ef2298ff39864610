// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "registration/seen_pin.h"

namespace dubsar {

/// The pins of one scan and the surface that they are to place.
struct ScanPins {
  int id = 0;
  std::vector<SeenPin> tips;
  Eigen::Vector3d surface_center_mm{0, 0, 0};  ///< scanner frame
  double surface_radius_mm = 20;               ///< of the surface about its centre
};

struct PinAdviceOptions {
  double replaced_sigma_mm = 0.3;  ///< of a tip per axis, each time pins are put back
  std::size_t least_labelled =
      4;  ///< pins that a scan should show, and share with an earlier one, by labels …
  std::size_t least_unlabelled = 6;  ///< … and without
  double most_turn_deg = 2.5;    ///< standard deviation: a first pose helps when it is right to 5 degrees …
  double most_surface_mm = 1.5;  ///< … and 3 mm
  double too_close_mm = 2.0;     ///< pins nearer to each other than this are mixed up
};

enum class PinFault {
  kNone,
  kNotSeen,    ///< no tip at all
  kTooFew,     ///< in this scan
  kInLine,     ///< the turn about the line is open
  kBunched,    ///< the pose that they give is too poor
  kTooClose,   ///< two of them are mixed up
  kNotShared,  ///< earlier scans show too few of them
  kMoved,      ///< one of them does not fit the others: put back elsewhere, or mislabelled
};

struct PinAdvice {
  PinFault fault = PinFault::kNone;
  double turn_sigma_deg = 0;    ///< expected of the first pose about its worst axis, from putting pins back
  double surface_sigma_mm = 0;  ///< expected displacement of a point on the surface (root of the mean square)
  int pin = -1;                 ///< index of the tip in question, -1: none
  std::string say;              ///< one line for the operator; empty when nothing is at fault
};

/// What is wrong with the pins of the latest scan, given the earlier ones: too few, nearly in a line,
/// bunched, too close, not those that earlier scans show; which one to move, and to which edge as the scan
/// shows it (x to the right, y upwards). The expected error of the pose is that of Horn's solution: the
/// inverse of its normal matrix with both scans' pins off by replaced_sigma_mm.
[[nodiscard]] PinAdvice advise_pins(const ScanPins& latest, std::span<const ScanPins> earlier,
                                    const PinAdviceOptions& options = {});

}  // namespace dubsar
