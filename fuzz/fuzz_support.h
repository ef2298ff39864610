// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/mesh.h"
#include "core/range_grid.h"

namespace dubsar::fuzz {

[[nodiscard]] inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A place of this process, in memory where there is such a thing: the disk's speed is not what is looked
/// for.
[[nodiscard]] inline std::filesystem::path work_path() {
  std::error_code ignored;
  const std::filesystem::path base = std::filesystem::is_directory("/dev/shm", ignored)
                                         ? std::filesystem::path("/dev/shm")
                                         : std::filesystem::temp_directory_path();
  return base / ("dubsar-fuzz-" + std::to_string(::getpid()));
}

/// A reader that hands on something inconsistent is as wrong as one that crashes.
inline void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

inline void check_grid(const RangeGrid& grid) {
  const std::size_t n = static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.cols);
  require(grid.x.size() == n && grid.y.size() == n && grid.z.size() == n && grid.valid.size() == n);
  require(grid.intensity.empty() || grid.intensity.size() == n);
  require(grid.confidence.empty() || grid.confidence.size() == n);
  require(grid.rgb.empty() || grid.rgb.size() == 3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    require(grid.valid[i] == 0 || (grid.valid[i] == 1 && grid.point(i).allFinite()));
  }
}

inline void check_mesh(const Mesh& mesh) {
  const std::size_t n = mesh.positions.size();
  require(mesh.normals.empty() || mesh.normals.size() == n);
  require(mesh.reliability.empty() || mesh.reliability.size() == n);
  require(mesh.scans.empty() || mesh.scans.size() == n);
  require(mesh.flags.empty() || mesh.flags.size() == n);
  require(mesh.colours.empty() || mesh.colours.size() == n);
  for (const auto& p : mesh.positions) {
    require(p.allFinite());
  }
  for (const auto& face : mesh.faces) {
    require(face[0] < n && face[1] < n && face[2] < n);
  }
}

}  // namespace dubsar::fuzz
