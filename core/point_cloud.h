// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dubsar {

/// Points without an order, millimetres, as some scanners export them; acquisition/ resamples them to a
/// RangeGrid.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;   ///< [N], finite
  std::vector<Eigen::Vector3f> normals;  ///< [N] unit, or empty
  std::vector<float> intensity;          ///< [N] in [0,1], or empty
  std::vector<std::uint8_t> rgb;         ///< [3N], or empty
  std::string source;                    ///< the file's name
};

}  // namespace dubsar
