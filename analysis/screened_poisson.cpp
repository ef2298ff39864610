// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/screened_poisson.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/buckets.h"
#include "analysis/multigrid.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 16U;

/// The eight nodes around a place and their trilinear weights.
struct Corners {
  std::size_t node = 0;
  std::array<float, 8> weight{};  ///< x fastest
};

std::size_t corner_node(const NodeGrid& grid, std::size_t node, std::size_t k) {
  return node + (k & 1U) + ((k >> 1U) & 1U) * grid.row() + (k >> 2U) * grid.plane();
}

/// at: in cells, clamped into the grid.
Corners corners_of(const NodeGrid& grid, const Vector3f& at) {
  const Vector3f top(static_cast<float>(grid.nx - 2), static_cast<float>(grid.ny - 2),
                     static_cast<float>(grid.nz - 2));
  const Vector3f low = at.array().floor().max(0.0F).min(top.array());
  const Vector3f t = (at - low).array().max(0.0F).min(1.0F);
  Corners c;
  c.node = grid.index(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z()));
  for (std::size_t k = 0; k < 8; ++k) {
    c.weight[k] = ((k & 1U) != 0 ? t.x() : 1 - t.x()) * ((k & 2U) != 0 ? t.y() : 1 - t.y()) *
                  ((k & 4U) != 0 ? t.z() : 1 - t.z());
  }
  return c;
}

/// The 27 nodes around a place and their weights by the quadratic B-spline, which a sample's place in its
/// cell shows less through than it does through the trilinear one.
struct Patch {
  std::size_t node = 0;                          ///< the first
  std::array<std::array<float, 3>, 3> weight{};  ///< by axis
};

Patch patch_of(const NodeGrid& grid, const Vector3f& at) {
  const Vector3f top(static_cast<float>(grid.nx - 2), static_cast<float>(grid.ny - 2),
                     static_cast<float>(grid.nz - 2));
  const Vector3f middle = (at.array() + 0.5F).floor().max(1.0F).min(top.array());
  Patch patch;
  patch.node = grid.index(static_cast<int>(middle.x()) - 1, static_cast<int>(middle.y()) - 1,
                          static_cast<int>(middle.z()) - 1);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const float t = std::clamp(at[axis] - middle[axis], -0.5F, 0.5F);
    patch.weight[static_cast<std::size_t>(axis)] = {0.5F * (0.5F - t) * (0.5F - t), 0.75F - t * t,
                                                    0.5F * (0.5F + t) * (0.5F + t)};
  }
  return patch;
}

/// Samples by the layer of cells that they lie in; what writes to the nodes of a layer and its neighbours
/// goes over every fourth layer at a time, so that no two threads meet and the order of the sums is fixed.
class Layers {
 public:
  Layers(std::span<const PoissonSample> samples, const NodeGrid& grid) : samples_(samples) {
    const auto layers = static_cast<std::size_t>(grid.nz - 1);
    const Vector3f top(static_cast<float>(grid.nx - 1), static_cast<float>(grid.ny - 1),
                       static_cast<float>(grid.nz - 1));
    by_layer_ = make_buckets(samples.size(), layers, [&](std::size_t i) {
      const Vector3f at = grid.place(samples[i].position_mm);
      const bool in = (at.array() >= 0).all() && (at.array() < top.array()).all();
      return in ? static_cast<std::size_t>(at.z()) : layers;
    });
  }
  [[nodiscard]] std::size_t size() const { return by_layer_.start.back(); }

  template <class Body>
  void scatter(const Body& body) const {
    const std::size_t layers = by_layer_.start.size() - 1;
    for (std::size_t colour = 0; colour < kApart; ++colour) {
      parallel_for_each_index((layers + kApart - 1 - colour) / kApart,
                              [&](std::size_t k) {
                                const std::size_t layer = kApart * k + colour;
                                for (std::uint32_t i = by_layer_.start[layer]; i < by_layer_.start[layer + 1];
                                     ++i) {
                                  body(i, samples_[by_layer_.item[i]]);
                                }
                              },
                              1);
    }
  }

 private:
  static constexpr std::size_t kApart = 4;
  std::span<const PoissonSample> samples_;
  Buckets by_layer_;
};

/// −div V at the nodes. V_x lies on the middles of the edges along x, and so on.
std::vector<float> right_side(const Layers& layers, const NodeGrid& grid) {
  std::vector<float> b(grid.count(), 0.0F);
  std::vector<float> v(grid.count());  // of the edge that leads onward from the node
  const float per_h3 = 1.0F / (grid.cell_mm * grid.cell_mm * grid.cell_mm);
  for (int axis = 0; axis < 3; ++axis) {
    std::fill(v.begin(), v.end(), 0.0F);
    Vector3f shift = Vector3f::Zero();
    shift[axis] = 0.5F;
    layers.scatter([&](std::uint32_t, const PoissonSample& s) {
      const Patch patch = patch_of(grid, grid.place(s.position_mm) - shift);
      const float inward = -s.area_normal_mm2[axis] * per_h3;
      for (std::size_t z = 0; z < 3; ++z) {
        for (std::size_t y = 0; y < 3; ++y) {
          float* const row = &v[patch.node + y * grid.row() + z * grid.plane()];
          const float share = inward * patch.weight[1][y] * patch.weight[2][z];
          for (std::size_t x = 0; x < 3; ++x) {
            row[x] += share * patch.weight[0][x];
          }
        }
      }
    });
    const std::size_t step = axis == 0 ? 1 : axis == 1 ? grid.row() : grid.plane();
    const float per_h = 1.0F / grid.cell_mm;
    parallel_for_each_index(
        static_cast<std::size_t>(grid.nz),
        [&](std::size_t z) {
          for (int y = 0; y < grid.ny; ++y) {
            const std::size_t row = grid.index(0, y, static_cast<int>(z));
            for (int x = 0; x < grid.nx; ++x) {
              const int place = axis == 0 ? x : axis == 1 ? y : static_cast<int>(z);
              const int last = (axis == 0 ? grid.nx : axis == 1 ? grid.ny : grid.nz) - 1;
              const std::size_t i = row + static_cast<std::size_t>(x);
              b[i] -= per_h * ((place < last ? v[i] : 0.0F) - (place > 0 ? v[i - step] : 0.0F));
            }
          }
        },
        1);
  }
  return b;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  return parallel_reduce_ordered(
      a.size(), kGrain, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
          sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
        }
        return sum;
      },
      [](double& into, double part) { into += part; });
}

/// to = a·to + b·from
void combine(std::vector<float>& to, float a, float b, const std::vector<float>& from) {
  parallel_for_each_index(
      to.size(), [&](std::size_t i) { to[i] = a * to[i] + b * from[i]; }, kGrain);
}

}  // namespace

Indicator solve_screened_poisson(std::span<const PoissonSample> samples, const NodeGrid& grid,
                                 const PoissonOptions& options, const JobContext& job) {
  Indicator result;
  if (grid.nx < 3 || grid.ny < 3 || grid.nz < 3) {
    return result;
  }
  const Layers layers(samples, grid);
  const float per_node = options.screening / (grid.cell_mm * grid.cell_mm * grid.cell_mm * grid.cell_mm);
  // Each sample's corners and pin, once.
  struct Pin {
    Corners corners;
    float strength;
  };
  std::vector<Pin> pins(layers.size());
  layers.scatter([&](std::uint32_t i, const PoissonSample& s) {
    pins[i] = {corners_of(grid, grid.place(s.position_mm)), per_node * s.pin_mm2};
  });
  std::vector<float> diagonal(grid.count(), 1e-6F);
  layers.scatter([&](std::uint32_t i, const PoissonSample&) {
    for (std::size_t k = 0; k < 8; ++k) {
      diagonal[corner_node(grid, pins[i].corners.node, k)] += pins[i].corners.weight[k] * pins[i].strength;
    }
  });
  const auto apply = [&](const std::vector<float>& x, std::vector<float>& out) {
    apply_laplacian(grid, x, out);
    layers.scatter([&](std::uint32_t i, const PoissonSample&) {
      const Corners& c = pins[i].corners;
      float value = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        value += c.weight[k] * x[corner_node(grid, c.node, k)];
      }
      for (std::size_t k = 0; k < 8; ++k) {
        out[corner_node(grid, c.node, k)] += pins[i].strength * c.weight[k] * value;
      }
    });
  };
  std::vector<float> residual = right_side(layers, grid);
  const double start = std::sqrt(dot(residual, residual));
  if (!(start > 0) || !std::isfinite(start)) {
    return result;
  }
  Multigrid multigrid(grid, std::move(diagonal));
  std::vector<float> x(grid.count(), 0.0F);
  std::vector<float> z(grid.count());
  std::vector<float> ap(grid.count());
  multigrid.solve_roughly(residual, z);
  std::vector<float> direction = z;
  double rz = dot(residual, z);
  for (result.iterations = 0; result.iterations < options.most_iterations; ++result.iterations) {
    if (job.cancelled()) {
      return result;
    }
    apply(direction, ap);
    const double curvature = dot(direction, ap);
    if (!(curvature > 0)) {
      break;
    }
    const auto step = static_cast<float>(rz / curvature);
    combine(x, 1, step, direction);
    combine(residual, 1, -step, ap);
    result.residual = std::sqrt(dot(residual, residual)) / start;
    if (result.residual < options.tolerance) {
      break;
    }
    multigrid.solve_roughly(residual, z);
    const double next = dot(residual, z);
    combine(direction, static_cast<float>(next / rz), 1, z);
    rz = next;
  }
  result.value = std::move(x);
  return result;
}

}  // namespace dubsar
