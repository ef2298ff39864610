// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/body.h"

namespace dubsar::sim {

/// The surface of an nx × ny × nz box of cells: a closed quad mesh, watertight by construction.
class BoxLattice {
 public:
  BoxLattice(int nx, int ny, int nz);

  [[nodiscard]] std::size_t vertex_count() const { return places_.size(); }
  /// (i, j, k) of a vertex; at least one of them is 0 or the count of cells.
  [[nodiscard]] const Eigen::Vector3i& place(std::size_t vertex) const { return places_[vertex]; }
  /// Index of the vertex at a place on the box's surface.
  [[nodiscard]] std::uint32_t index(int i, int j, int k) const;
  /// Calls visit(a, b, c, d) for each quad, counter-clockwise seen from outside.
  template <class Visit>
  void for_each_quad(const Visit& visit) const;
  /// Neighbours along lattice edges: three at the eight corners, four elsewhere.
  [[nodiscard]] int neighbours(std::size_t vertex, std::array<std::uint32_t, 4>* out) const;
  [[nodiscard]] const Eigen::Vector3i& cells() const { return cells_; }

 private:
  [[nodiscard]] bool on_surface(const Eigen::Vector3i& p) const;
  Eigen::Vector3i cells_;
  std::vector<Eigen::Vector3i> places_;
};

/// A nearly evenly spaced grid on the body.
struct BodyGrid {
  BoxLattice lattice;
  std::vector<Eigen::Vector3d> points;   ///< [V], on the body
  std::vector<Eigen::Vector3d> normals;  ///< [V], of the body
};

/// Lays a grid of mean spacing_mm on the body.
[[nodiscard]] BodyGrid make_body_grid(const TabletBody& body, double spacing_mm);

template <class Visit>
void BoxLattice::for_each_quad(const Visit& visit) const {
  const int nx = cells_.x();
  const int ny = cells_.y();
  const int nz = cells_.z();
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      visit(index(i, j, nz), index(i + 1, j, nz), index(i + 1, j + 1, nz), index(i, j + 1, nz));
      visit(index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0));
    }
  }
  for (int k = 0; k < nz; ++k) {
    for (int i = 0; i < nx; ++i) {
      visit(index(i, 0, k), index(i + 1, 0, k), index(i + 1, 0, k + 1), index(i, 0, k + 1));
      visit(index(i, ny, k), index(i, ny, k + 1), index(i + 1, ny, k + 1), index(i + 1, ny, k));
    }
    for (int j = 0; j < ny; ++j) {
      visit(index(0, j, k), index(0, j, k + 1), index(0, j + 1, k + 1), index(0, j + 1, k));
      visit(index(nx, j, k), index(nx, j + 1, k), index(nx, j + 1, k + 1), index(nx, j, k + 1));
    }
  }
}

}  // namespace dubsar::sim
