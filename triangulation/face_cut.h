// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

namespace dubsar {

/// A face's plane: nothing of a face that lies on one side of it cuts through.
struct FacePlane {
  Eigen::Vector3d normal{0, 0, 0};  ///< of any length
  double offset = 0;

  FacePlane() = default;
  FacePlane(std::span<const Eigen::Vector3f> positions, const std::array<std::uint32_t, 3>& f);
};

/// Whether two faces cut through each other, `pa` being the plane of the first. Faces that share an edge do
/// not; of two that share a corner one may.
[[nodiscard]] bool faces_cut(std::span<const Eigen::Vector3f> positions,
                             const std::array<std::uint32_t, 3>& fa, const FacePlane& pa,
                             const std::array<std::uint32_t, 3>& fb);

}  // namespace dubsar
