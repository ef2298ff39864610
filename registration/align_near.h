// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "registration/model_fit.h"
#include "registration/verify_pose.h"

namespace dubsar {

struct AlignNearOptions {
  double turn_rad = 0.4;    ///< how far the start may be turned off, about the scan's centroid …
  double shift = 0.16;      ///< … and shifted, of the surfaces' common scale
  int tried = 400;          ///< poses around the start that are scored when the start alone leads nowhere …
  int quick_samples = 120;  ///< … by so many samples
  int refined = 10;         ///< of them that point-to-point ICP takes closer
  double doubtful = 0.7;    ///< a fit with more doubt than this (verify_pose.h) is not taken on first sight
  ModelFitOptions fit;
  VerifyOptions verify;
};

/// Registers a scan onto others from a start that is roughly right: an operator's hint, a hand turn that was
/// asked for, three point pairs. Point-to-point on the coarse level takes the start closer, point-to-plane
/// from coarse to fine does the rest (fit_to_model); when the surfaces speak against where that led, the
/// neighbourhood of the start is searched. Returns distinct fits, best first; none is verified.
/// Deterministic.
[[nodiscard]] std::vector<ModelFit> align_near(const ScanSurface& scan, std::span<const ModelScan> model,
                                               const RigidTransform& start, const AlignNearOptions& options);

}  // namespace dubsar
