// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/scan_pose.h"
#include "registration/depth_raster.h"
#include "station/station_scan.h"

namespace dubsar {

/// A scan that shows what is not of the tablet.
struct Intruder {
  int id = 0;
  int witness = 0;   ///< the scan that saw through it
  double share = 0;  ///< of its samples where that one looked
};

/// Finds scans in which a hand, a sleeve or a tool lay before the tablet. Such a thing stands in the air
/// where another scan saw through to the clay, and the other scan's samples stand nowhere in the way of the
/// first: so it is the one with the thing in it, whichever came first. Where both stand in each other's way
/// the tablet has moved, or a pose is wrong; that is for registration to say.
class IntruderFinder {
 public:
  void add(const StationScan& scan);
  void remove(int id);
  /// Holds the scan that came last against all others that `poses` tells of: by their poses where both are
  /// registered, else by what the motors say where the tablet was not lifted in between.
  [[nodiscard]] std::optional<Intruder> look(int newest, const std::vector<ScanPose>& poses) const;

 private:
  struct Known {
    std::vector<Eigen::Vector3f> points_mm;  ///< well sampled, scanner frame
    DepthRaster raster;
    std::optional<NominalPose> nominal;
    bool pins = false;
  };
  struct InTheWay {
    std::size_t points = 0;  ///< of a, that stand where b saw through
    std::size_t looked = 0;  ///< of a, where b saw anything all around
  };
  [[nodiscard]] static InTheWay in_the_way(const Known& a, const Known& b, const RigidTransform& b_from_a);

  std::map<int, Known> scans_;
};

}  // namespace dubsar
