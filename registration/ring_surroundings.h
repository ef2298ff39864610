// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "registration/scan_surface.h"

namespace dubsar {

/// A keypoint's tangent plane.
struct RingFrame {
  Eigen::Vector3f origin, normal, u, v;
};

/// The samples of a level around a keypoint and their places on rings × sectors of its tangent plane. Shape,
/// relief and tone are read from the same samples: finding them costs more than reading.
class RingSurroundings {
 public:
  static constexpr int kRings = 4;
  static constexpr int kSectors = 16;
  static constexpr std::size_t kCells = std::size_t{kRings} * kSectors;

  struct Place {
    std::size_t sample = 0;  ///< of the level
    std::size_t cell = 0;    ///< ring * kSectors + sector
    Eigen::Vector2f at;      ///< in the plane
    float height_mm = 0;     ///< over it
  };
  /// A place beside the middle of a cell.
  struct Beside {
    std::size_t place = 0;
    Eigen::Vector2f to_middle;
    float weight = 0;
  };

  /// Looks around one keypoint, in place of the one before.
  void look(const SurfaceLevel& level, const RingFrame& frame, float radius_mm);

  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  /// The places near enough to a cell's middle to tell what lies there, in their order; worked out when it is
  /// first asked for.
  [[nodiscard]] std::span<const Beside> beside(std::size_t cell);

 private:
  struct Known {
    bool is = false;
    std::size_t begin = 0, end = 0;  ///< in beside_
  };
  float radius_mm_ = 0;
  float reach_mm_ = 0;
  std::vector<Place> places_;
  std::vector<Beside> beside_;
  std::array<Known, kCells> known_;
};

}  // namespace dubsar
