// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/result.h"
#include "station/command/three_numbers.h"

namespace dubsar {

/// "50x40x20", each side of the tablet 3 to 1000 mm.
[[nodiscard]] inline Result<Eigen::Vector3d> parse_size_mm(const std::string& text) {
  const std::optional<Eigen::Vector3d> size = three_numbers(text, 'x');
  if (!size || !(size->array() >= 3 && size->array() <= 1000).all()) {
    return fail(ErrorKind::kUsage, "\"" + text + "\" is no size of a tablet", "--size",
                "width x height x thickness in mm, as in 50x40x20");
  }
  return *size;
}

}  // namespace dubsar
