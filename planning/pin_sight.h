// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "planning/tablet_hull.h"

namespace dubsar {

/// What a pin looks like: a tip ball on an arm that is a cone (the simulator's, and those of common
/// articulated holders). Beyond its length the arm is led away by its joints and is not looked at.
struct PinShape {
  double tip_radius_mm = 0.5;
  double gap_mm = 1.5;         ///< between tip ball and clay, where the pin stands as near as it may
  double most_gap_mm = 6.0;    ///< as far as a tip may stand and still point at its place without doubt
  double arm_radius_mm = 1.5;  ///< at the arm's far end; tip_radius_mm at the tip
  double arm_length_mm = 30;

  friend bool operator==(const PinShape&, const PinShape&) = default;
};

/// A pin in the tablet frame.
struct PinPose {
  Eigen::Vector3d tip_mm{0, 0, 0};  ///< centre of the tip ball
  Eigen::Vector3d arm{0, 0, 1};     ///< unit, from the tip away from the tablet
};

/// A view: unit directions from the tablet to the laser and to the camera. Rays are parallel: the scanner is
/// far away for its field.
struct SightView {
  Eigen::Vector3d to_laser{0, 0, 1};
  Eigen::Vector3d to_camera{0, 0, 1};
};

/// The view with the camera `triangulation_rad` beside the laser, rolled about the laser's direction. The
/// roll counts from a direction that depends on to_laser alone.
[[nodiscard]] SightView sight_view(const Eigen::Vector3d& to_laser, double roll_rad,
                                   double triangulation_rad);

/// A direction with all others that differ from it by at most `margin` (chord of the unit sphere, about
/// radians). Whatever is said to be seen or unshaded from it holds for every one of them.
class Sightline {
 public:
  Sightline(const TabletHull& hull, const Eigen::Vector3d& direction, double margin);

  [[nodiscard]] const Eigen::Vector3d& direction() const { return direction_; }
  [[nodiscard]] double margin() const { return margin_; }
  /// n_k · direction.
  [[nodiscard]] std::span<const double> facing() const { return facing_; }

 private:
  Eigen::Vector3d direction_;
  double margin_;
  std::vector<double> facing_;
};

/// A pin made ready for many views: balls that cover its tip and arm, and their distances to the hull's
/// planes. The first ball is the tip itself.
class PinBody {
 public:
  PinBody(const TabletHull& hull, const PinPose& pose, const PinShape& shape);

  struct Ball {
    Eigen::Vector3d center_mm{0, 0, 0};
    double radius_mm = 0;
  };
  [[nodiscard]] std::span<const Ball> balls() const { return balls_; }
  [[nodiscard]] const Ball& tip() const { return balls_.front(); }

  /// The whole tip ball has a free line to the direction, past the tablet.
  [[nodiscard]] bool tip_is_free(const Sightline& to) const;
  /// Some part of the pin stands between the direction and clay that `from` and `other` both see when the pin
  /// is not there.
  [[nodiscard]] bool shades(const Sightline& from, const Sightline& other) const;
  /// The contrary in every view within the margins.
  [[nodiscard]] bool tip_is_never_free(const Sightline& to) const;
  [[nodiscard]] bool always_shades(const Sightline& from, const Sightline& other) const;
  /// Part of the other pin stands before this one's tip.
  [[nodiscard]] bool tip_is_behind(const PinBody& other, const Sightline& to) const;
  /// Directions farther than this from `axis` see nothing of the other pin before this one's tip.
  struct Shield {
    Eigen::Vector3d axis{0, 0, 1};  ///< unit
    double least_cosine = -1;
  };
  [[nodiscard]] Shield shield_of(const PinBody& other, double margin) const;
  /// Least distance between the two pins' surfaces (balls), negative when they meet.
  [[nodiscard]] double distance_mm(const PinBody& other) const;

 private:
  std::vector<Ball> balls_;
  std::vector<double> slack_mm_;  ///< [balls * planes] s_k - n_k · center + radius
  std::size_t planes_;
};

/// In a view a pin may *stand* when it hides no clay: nothing that laser and camera both see on the bare
/// tablet is hidden from either of them by the pin's tip or arm. It *shows* when the tablet hides no part of
/// its tip from laser or camera. Pins that do not do both are taken away for that scan. A pin is *seen* when
/// it stands and shows, and no other pin that does stands before its tip, seen from the laser or from the
/// camera. This is all but the other pins.
[[nodiscard]] bool stands_and_shows(const PinBody& pin, const Sightline& laser, const Sightline& camera);
/// In none of the views within the margins does the pin stand and show; with margins of zero the opposite of
/// stands_and_shows().
[[nodiscard]] bool never_stands_and_shows(const PinBody& pin, const Sightline& laser,
                                          const Sightline& camera);

}  // namespace dubsar
