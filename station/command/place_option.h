// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <charconv>
#include <cmath>
#include <string>

#include "core/result.h"

namespace dubsar {

/// A place in mm as it is said to `option`: x,y,z.
[[nodiscard]] inline Result<Eigen::Vector3d> place_of(const std::string& text, const char* option) {
  Eigen::Vector3d out;
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (int k = 0; k < 3; ++k) {
    const auto [next, error] = std::from_chars(at, end, out[k]);
    const bool parted = k == 2 ? next == end : next != end && *next == ',';
    if (error != std::errc() || !parted || !std::isfinite(out[k])) {
      return fail(ErrorKind::kUsage, "'" + text + "' is no place", option, "write x,y,z in mm");
    }
    at = next + (k < 2 ? 1 : 0);
  }
  return out;
}

}  // namespace dubsar
