// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/body_grid.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr int kCoarseCells = 18;
constexpr int kRelaxSweeps = 320;
/// Larger steps make neighbours swing against each other.
constexpr double kRelaxStep = 0.4;

/// Length of the body's outline in the plane of two axes, through the centre.
double outline_mm(const TabletBody& body, int axis_a, int axis_b) {
  constexpr int kSteps = 720;
  double length = 0;
  Eigen::Vector3d last;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 2.0 * kPi * i / kSteps;
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    d[axis_a] = std::cos(angle) * body.half_size_mm()[axis_a];
    d[axis_b] = std::sin(angle) * body.half_size_mm()[axis_b];
    const Eigen::Vector3d p = body.radial(d);
    if (i > 0) {
      length += (p - last).norm();
    }
    last = p;
  }
  return length;
}

/// A coarse lattice on the even body, slid over the surface until its spacing is even.
std::vector<Eigen::Vector3d> relaxed_points(const TabletBody& even, const BoxLattice& lattice) {
  std::vector<Eigen::Vector3d> points(lattice.vertex_count());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3d d;
    for (int axis = 0; axis < 3; ++axis) {
      d[axis] = (2.0 * lattice.place(i)[axis] / lattice.cells()[axis] - 1.0) * even.half_size_mm()[axis];
    }
    points[i] = even.radial(d);
  }
  std::vector<Eigen::Vector3d> next(points.size());
  for (int sweep = 0; sweep < kRelaxSweeps; ++sweep) {
    parallel_for_each_index(points.size(), [&](std::size_t i) {
      std::array<std::uint32_t, 4> around{};
      const int count = lattice.neighbours(i, &around);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double weights = 0;
      for (int k = 0; k < count; ++k) {
        // Long edges pull harder, which evens out lengths where plain averaging bunches up at the rim.
        const Eigen::Vector3d to = points[around[static_cast<std::size_t>(k)]] - points[i];
        const double weight = to.norm();
        sum += weight * to;
        weights += weight;
      }
      next[i] = even.project(points[i] + kRelaxStep * sum / weights);
    });
    points.swap(next);
  }
  return points;
}

/// The coarse cell and the place in it for fine line i of n.
struct CellPlace {
  int cell;
  double t;
};
CellPlace cell_place(int i, int n, int coarse) {
  const double s = static_cast<double>(i) * coarse / n;
  const int cell = std::min(coarse - 1, static_cast<int>(s));
  return {cell, s - cell};
}

}  // namespace

BoxLattice::BoxLattice(int nx, int ny, int nz) : cells_(nx, ny, nz) {
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      const bool whole_row = k == 0 || k == nz || j == 0 || j == ny;
      for (int i = 0; i <= nx; i += whole_row ? 1 : nx) {
        places_.emplace_back(i, j, k);
      }
    }
  }
}

std::uint32_t BoxLattice::index(int i, int j, int k) const {
  const int nx = cells_.x();
  const int ny = cells_.y();
  const int nz = cells_.z();
  const int layer = (nx + 1) * (ny + 1);
  const int ring = 2 * (nx + 1) + 2 * (ny - 1);
  if (k == 0) {
    return static_cast<std::uint32_t>(j * (nx + 1) + i);
  }
  const int base = layer + (k - 1) * ring;
  if (k == nz) {
    return static_cast<std::uint32_t>(base + j * (nx + 1) + i);
  }
  if (j == 0) {
    return static_cast<std::uint32_t>(base + i);
  }
  if (j == ny) {
    return static_cast<std::uint32_t>(base + (nx + 1) + 2 * (ny - 1) + i);
  }
  return static_cast<std::uint32_t>(base + (nx + 1) + 2 * (j - 1) + (i == 0 ? 0 : 1));
}

bool BoxLattice::on_surface(const Eigen::Vector3i& p) const {
  bool border = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < 0 || p[axis] > cells_[axis]) {
      return false;
    }
    border = border || p[axis] == 0 || p[axis] == cells_[axis];
  }
  return border;
}

int BoxLattice::neighbours(std::size_t vertex, std::array<std::uint32_t, 4>* out) const {
  std::size_t count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      Eigen::Vector3i p = places_[vertex];
      p[axis] += step;
      if (count < out->size() && on_surface(p)) {
        (*out)[count++] = index(p.x(), p.y(), p.z());
      }
    }
  }
  return static_cast<int>(count);
}

BodyGrid make_body_grid(const TabletBody& body, double spacing_mm) {
  const TabletBody even = body.even();
  const double xy = outline_mm(even, 0, 1);
  const double xz = outline_mm(even, 0, 2);
  const double yz = outline_mm(even, 1, 2);
  // Each outline crosses two faces of the box twice: three equations for three cell counts.
  const Eigen::Vector3d lengths(xy + xz - yz, xy + yz - xz, xz + yz - xy);
  Eigen::Vector3i fine;
  Eigen::Vector3i coarse;
  for (int axis = 0; axis < 3; ++axis) {
    fine[axis] = std::max(4, static_cast<int>(std::lround(0.25 * lengths[axis] / spacing_mm)));
    coarse[axis] =
        std::max(4, static_cast<int>(std::lround(kCoarseCells * lengths[axis] / lengths.maxCoeff())));
  }
  const BoxLattice rough(coarse.x(), coarse.y(), coarse.z());
  const std::vector<Eigen::Vector3d> anchors = relaxed_points(even, rough);

  BodyGrid grid{BoxLattice(fine.x(), fine.y(), fine.z()), {}, {}};
  grid.points.resize(grid.lattice.vertex_count());
  grid.normals.resize(grid.points.size());
  parallel_for_each_index(grid.points.size(), [&](std::size_t i) {
    const Eigen::Vector3i& place = grid.lattice.place(i);
    // The axis whose face this vertex lies on stays fixed; the other two are interpolated.
    int fixed = 0;
    while (place[fixed] != 0 && place[fixed] != fine[fixed]) {
      ++fixed;
    }
    const int a = fixed == 0 ? 1 : 0;
    const int b = fixed == 2 ? 1 : 2;
    const CellPlace pa = cell_place(place[a], fine[a], coarse[a]);
    const CellPlace pb = cell_place(place[b], fine[b], coarse[b]);
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 4; ++corner) {
      Eigen::Vector3i at;
      at[fixed] = place[fixed] == 0 ? 0 : coarse[fixed];
      at[a] = pa.cell + (corner & 1);
      at[b] = pb.cell + (corner >> 1);
      const double weight =
          ((corner & 1) != 0 ? pa.t : 1.0 - pa.t) * ((corner >> 1) != 0 ? pb.t : 1.0 - pb.t);
      p += weight * anchors[rough.index(at.x(), at.y(), at.z())];
    }
    grid.points[i] = body.project(p);
    grid.normals[i] = body.normal(grid.points[i]);
  });
  return grid;
}

}  // namespace dubsar::sim
