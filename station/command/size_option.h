// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <string>

#include "core/result.h"

namespace dubsar {

/// "50x40x20", each side of the tablet 3 to 1000 mm.
[[nodiscard]] inline Result<Eigen::Vector3d> parse_size_mm(const std::string& text) {
  Eigen::Vector3d size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lfx%lfx%lf%c", &size.x(), &size.y(), &size.z(), &rest) != 3 ||
      !(size.minCoeff() >= 3 && size.maxCoeff() <= 1000)) {
    return fail(ErrorKind::kUsage, "\"" + text + "\" is no size of a tablet", "--size",
                "width x height x thickness in mm, as in 50x40x20");
  }
  return size;
}

}  // namespace dubsar
