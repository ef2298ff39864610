// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// What a package says of every vertex, and draws.
struct PackageFields {
  std::vector<float> openness;  ///< [V] ambient occlusion, 0 buried to 1 open
  std::vector<float>
      invariants;  ///< [V] the integral invariant of largest magnitude over the scales, -1 to 1
};

/// Invariants within 1 mm. Errors: kCancelled.
[[nodiscard]] Result<PackageFields> package_fields(const Mesh& mesh, const JobContext& job);

}  // namespace dubsar
