// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "registration/model_fit.h"

namespace dubsar {

/// A scan of a model, and where it lies there.
struct PlacedSurface {
  std::shared_ptr<const ScanSurface> surface;
  RigidTransform model_from_scanner;
};

/// What judging a scan among others (judge_in_model) came to the last time, for when it is asked again and
/// nothing has changed: each check of a model judges its scans, and most of them stand where they stood. Kept
/// by all that it follows from, to the last digit: poses by their numbers, surfaces, which are immutable, by
/// who they are. Keeps none of them in memory.
class LastJudgement {
 public:
  /// The same as judge_in_model(). The options must be the same each time.
  const ModelFit& of(const PlacedSurface& scan, std::span<const PlacedSurface> others,
                     const ModelFitOptions& options);
  /// True when that was the last one, and costs nothing.
  [[nodiscard]] bool is_of(const PlacedSurface& scan, std::span<const PlacedSurface> others) const;

 private:
  /// One that was judged or judged by. Weak: a surface that is gone is no other's equal, even when that one
  /// has come to lie at its address.
  struct Seen {
    std::weak_ptr<const ScanSurface> surface;
    RigidTransform model_from_scanner;

    [[nodiscard]] bool is(const PlacedSurface& placed) const;
  };
  std::vector<Seen> seen_;  ///< the scan first; empty before the first
  ModelFit fit_;
};

/// For what takes a model.
[[nodiscard]] std::vector<ModelScan> model_scans(std::span<const PlacedSurface> placed);

}  // namespace dubsar
