// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/node_grid.h"
#include "core/mesh.h"

namespace dubsar {

/// The tablet's surface as if nothing had been impressed: signed distances to the low-resolution Poisson
/// reconstruction (seed 000, 3.3), on a regular grid within a band around it. Safe to query from many
/// threads.
class HeightSurface {
 public:
  HeightSurface() = default;
  /// distance_mm: [nodes], clamped to −below_mm in the clay, where it is negative, and to above_mm outside.
  HeightSurface(Mesh mesh, const NodeGrid& grid, float below_mm, float above_mm,
                std::vector<float> distance_mm);

  /// Signed distance of p to the surface, negative below it (in the clay); trilinear between the nodes.
  /// Clamped to −band_mm() deep in the clay and to above_mm outside.
  [[nodiscard]] float height_mm(const Eigen::Vector3f& p_mm) const;
  /// Unit, out of the clay, of the surface nearest p; zero outside the band.
  [[nodiscard]] Eigen::Vector3f normal(const Eigen::Vector3f& p_mm) const;
  /// The point of the surface nearest p (Newton steps along the normal); nothing outside the band.
  [[nodiscard]] std::optional<Eigen::Vector3f> closest(const Eigen::Vector3f& p_mm) const;
  /// The first point where the ray from p along the unit direction crosses from below the surface to above
  /// it, or above to below, within reach_mm.
  [[nodiscard]] std::optional<Eigen::Vector3f> crossing(const Eigen::Vector3f& p_mm,
                                                        const Eigen::Vector3f& direction,
                                                        float reach_mm) const;

  /// Moves the surface by outward_mm(p) along its normals: little, and slowly varying.
  void shift(const std::function<float(const Eigen::Vector3f& p_mm)>& outward_mm);

  /// The reconstruction itself, as triangles of about one cell, with normals.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] float cell_mm() const { return grid_.cell_mm; }
  [[nodiscard]] float band_mm() const { return band_mm_; }

 private:
  struct Cell {
    std::size_t node;
    Eigen::Vector3f t;  ///< place in the cell, [0,1] each
  };
  [[nodiscard]] std::optional<Cell> cell_at(const Eigen::Vector3f& p_mm) const;
  [[nodiscard]] std::array<float, 8> corners(const Cell& cell) const;

  Mesh mesh_;
  NodeGrid grid_;
  float band_mm_ = 0;
  float above_mm_ = 0;
  std::vector<float> distance_mm_;  ///< [nodes]
};

}  // namespace dubsar
