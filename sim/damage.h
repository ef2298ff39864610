// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sim/body.h"
#include "sim/tablet.h"

namespace dubsar::sim {

/// What time has done to one tablet: where it broke, wore, cracked and filled with dirt.
class Damage {
 public:
  Damage(const TabletBody& body, const DamageOptions& options, double spacing_mm, std::uint64_t seed);

  /// How worn the surface is at p, 0 to 1.
  [[nodiscard]] double erosion(const Eigen::Vector3d& p) const { return strongest(worn_, p); }
  /// Height up to which dirt fills hollows at p; far below the surface where there is none.
  [[nodiscard]] double dirt_level_mm(const Eigen::Vector3d& p) const;
  /// How deep a crack goes at p; 0 where there is none.
  [[nodiscard]] double crack_mm(const Eigen::Vector3d& p) const;
  /// How deep a firing hole goes at p; 0 where there is none.
  [[nodiscard]] double hole_mm(const Eigen::Vector3d& p) const;
  /// How far p lies beyond a fracture face; 0 where nothing broke.
  [[nodiscard]] double broken_off_mm(const Eigen::Vector3d& p) const;
  /// Moves a surface point that has broken off onto the fracture face, towards the tablet's centre; false
  /// where nothing broke.
  [[nodiscard]] bool fracture(Eigen::Vector3d* p) const;

 private:
  struct Patch {
    Eigen::Vector3d centre;
    double radius;
    double strength;
  };
  struct Crack {
    Eigen::Vector3d centre, across;
    double length, width, depth;
    std::uint64_t seed;
  };
  struct Hole {
    Eigen::Vector3d centre, axis;  ///< axis out of the clay
    double radius, depth;
  };
  struct Break {
    Eigen::Vector3d normal;
    double offset;
    double rough_mm;
    std::uint64_t seed;
  };
  [[nodiscard]] static double strongest(const std::vector<Patch>& patches, const Eigen::Vector3d& p);

  /// Where the rough face lies along the break's normal, on the ray from the centre through p.
  [[nodiscard]] static double face_along(const Break& broken, const Eigen::Vector3d& p, double along);

  std::vector<Patch> worn_, dirty_;
  std::vector<Crack> cracks_;
  std::vector<Hole> holes_;
  double wall_mm_;  ///< over which a hole's wall falls
  std::vector<Break> breaks_;
  std::uint64_t seed_;
};

}  // namespace dubsar::sim
