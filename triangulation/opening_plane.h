// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "triangulation/front.h"

namespace dubsar {

/// Mean µ around an opening.
[[nodiscard]] float mean_spacing_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening);

/// What is known around an opening (a walk from Front::walks()), in its mean plane. All in mm.
class OpeningPlane {
 public:
  /// Nothing where the normals around the opening look all ways, so that no plane is one.
  [[nodiscard]] static std::optional<OpeningPlane> of(const Sheet& sheet,
                                                      const std::vector<std::uint32_t>& opening);

  [[nodiscard]] float spacing_mm() const { return spacing_mm_; }
  [[nodiscard]] const Eigen::Vector3f& normal() const { return normal_; }
  [[nodiscard]] Eigen::Vector2f low() const { return low_; }  ///< corners of the box around the opening
  [[nodiscard]] Eigen::Vector2f high() const { return high_; }
  [[nodiscard]] Eigen::Vector2f place_of(const Eigen::Vector3f& p) const {
    return {u_.dot(p - centre_), v_.dot(p - centre_)};
  }
  [[nodiscard]] float height_of(const Eigen::Vector3f& p) const { return normal_.dot(p - centre_); }
  [[nodiscard]] Eigen::Vector3f at(const Eigen::Vector2f& p, float height) const {
    return centre_ + u_ * p.x() + v_ * p.y() + normal_ * height;
  }

  [[nodiscard]] bool encloses(const Eigen::Vector2f& p) const;
  [[nodiscard]] float distance2_to_edges(const Eigen::Vector2f& p) const;
  [[nodiscard]] float distance2_to_vertices(const Eigen::Vector2f& p) const;

  struct Interpolated {
    float height = 0;
    float sigma = 0;
  };
  /// Between the heights of the rim by mean value coordinates (Floater 2003). The heights may all be off the
  /// same way, by the poses of scans. How far clay that nobody saw lies from there is told by how it goes
  /// into the opening: where it bends evenly it lies half way between the interpolated height and the planes
  /// that touch it at the rim, and at a step one of these planes is right. What noise makes of a plane
  /// through samples two spacings apart is taken off.
  [[nodiscard]] Interpolated interpolate(const Eigen::Vector2f& p) const;

 private:
  float spacing_mm_ = 0;
  Eigen::Vector3f centre_, normal_, u_, v_;
  Eigen::Vector2f low_, high_;
  std::vector<Eigen::Vector2f> places_;
  std::vector<float> heights_;
  std::vector<Eigen::Vector2f> slopes_;  ///< of the clay, by the normals
  std::vector<float> variances_;         ///< of the heights
};

}  // namespace dubsar
