// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/wedge.h"

namespace dubsar {

/// What is known about a simulated tablet.
struct TabletTruth {
  std::string mesh;  ///< file name of the true surface
  std::uint64_t seed = 0;
  Eigen::Vector3d size_mm{0, 0, 0};  ///< width, height, thickness; zero when not told
  double spacing_mm = 0;             ///< of the mesh; zero when not told
  std::vector<Wedge> wedges;
};

/// truth.json: the keys of the Wedges contract (degrees at the surface, millimetres), besides `seed`, `size`,
/// `spacing_mm` and `intact` of every wedge.
[[nodiscard]] std::string truth_to_json(const TabletTruth& truth);
[[nodiscard]] Status write_truth(const std::filesystem::path& path, const TabletTruth& truth);
[[nodiscard]] Result<TabletTruth> parse_truth(std::string_view text, const std::string& where);
[[nodiscard]] Result<TabletTruth> read_truth(const std::filesystem::path& path);

}  // namespace dubsar
