// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>
#include <string>

namespace dubsar::test {

/// A range grid of a bumpy patch, 0.25 mm from sample to sample, whose header says 2.5.
[[nodiscard]] inline std::string ply_of_wrong_spacing() {
  constexpr int kSide = 60;
  std::string text =
      "ply\nformat ascii 1.0\nobj_info num_cols 60\nobj_info num_rows 60\nobj_info dubsar_spacing_mm 2.5\n"
      "obj_info dubsar_direction 0 0 -1\nelement vertex 3600\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  for (int i = 0; i < kSide * kSide; ++i) {
    const double x = 0.25 * (i % kSide);
    const double y = 0.25 * (i / kSide);
    text += std::to_string(x) + " " + std::to_string(y) + " " +
            std::to_string(std::sin(x) * std::cos(0.7 * y)) + "\n";
  }
  return text;
}

}  // namespace dubsar::test
