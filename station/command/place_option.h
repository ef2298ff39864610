// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/result.h"
#include "station/command/three_numbers.h"

namespace dubsar {

/// A place in mm as it is said to `option`: x,y,z.
[[nodiscard]] inline Result<Eigen::Vector3d> place_of(const std::string& text, const char* option) {
  const std::optional<Eigen::Vector3d> out = three_numbers(text, ',');
  if (!out || !out->allFinite()) {
    return fail(ErrorKind::kUsage, "'" + text + "' is no place", option, "write x,y,z in mm");
  }
  return *out;
}

}  // namespace dubsar
