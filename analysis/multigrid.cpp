// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Briggs, Henson, McCormick: A Multigrid Tutorial, 2000. Conjugate gradients around it are in
// screened_poisson.cpp.
#include "analysis/multigrid.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/parallel.h"

namespace dubsar {
namespace {

/// No side of the coarsest grid is longer than this.
constexpr int kCoarsest = 8;
constexpr int kCoarsestSweeps = 24;

/// body(y, z) for all rows, in parallel.
template <class Body>
void for_rows(const NodeGrid& grid, const Body& body) {
  const auto rows = static_cast<std::size_t>(grid.ny) * static_cast<std::size_t>(grid.nz);
  const std::size_t grain = std::max<std::size_t>(8, 16384 / grid.row());
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        body(static_cast<int>(r % static_cast<std::size_t>(grid.ny)),
             static_cast<int>(r / static_cast<std::size_t>(grid.ny)));
      },
      grain);
}

/// The rows beside row (y, z), the row itself where the grid ends, and how many there are.
struct Beside {
  std::size_t here;
  std::array<std::size_t, 4> rows;
  float count;
};

Beside beside(const NodeGrid& grid, int y, int z) {
  const std::size_t here = grid.index(0, y, z);
  Beside b{here, {here, here, here, here}, 0};
  const auto take = [&](std::size_t k, bool there, std::size_t row) {
    if (there) {
      b.rows[k] = row;
      b.count += 1;
    }
  };
  take(0, y > 0, here - grid.row());
  take(1, y + 1 < grid.ny, here + grid.row());
  take(2, z > 0, here - grid.plane());
  take(3, z + 1 < grid.nz, here + grid.plane());
  return b;
}

/// The four rows beside one.
struct RowsBeside {
  const float* below;
  const float* above;
  const float* before;
  const float* behind;

  RowsBeside(const Beside& at, const std::vector<float>& x)
      : below(&x[at.rows[0]]), above(&x[at.rows[1]]), before(&x[at.rows[2]]), behind(&x[at.rows[3]]) {}
};

/// Relaxes the nodes of one colour. Where a neighbour is missing the node itself stands in for it: the
/// update solves for the neighbours that there are.
void relax(const NodeGrid& grid, const std::vector<float>& diagonal, const std::vector<float>& b,
           std::vector<float>& x, int colour) {
  const float h2 = grid.cell_mm * grid.cell_mm;
  for_rows(grid, [&](int y, int z) {
    const Beside at = beside(grid, y, z);
    const int nx = grid.nx;
    const auto [below, above, before, behind] = RowsBeside(at, x);
    const float* const d = &diagonal[at.here];
    const float* const r = &b[at.here];
    float* const row = &x[at.here];
    const float missing = 4.0F - at.count;
    const auto update = [&](int i, float along, float count) {
      const float sum = below[i] + above[i] + before[i] + behind[i] - missing * row[i] + along;
      row[i] = (h2 * r[i] + sum) / (count + at.count + h2 * d[i]);
    };
    const int first = (y + z + colour) & 1;
    if (first == 0) {
      update(0, row[1], 1);
    }
    for (int i = first == 0 ? 2 : 1; i + 1 < nx; i += 2) {
      update(i, row[i - 1] + row[i + 1], 2);
    }
    if (((nx - 1 - first) & 1) == 0) {
      update(nx - 1, row[nx - 2], 1);
    }
  });
}

template <bool kResidual>
void laplacian_or_residual(const NodeGrid& grid, const float* diagonal, const float* b,
                           const std::vector<float>& x, std::vector<float>& out) {
  const float per_h2 = 1.0F / (grid.cell_mm * grid.cell_mm);
  for_rows(grid, [&](int y, int z) {
    const Beside at = beside(grid, y, z);
    const int nx = grid.nx;
    const auto [below, above, before, behind] = RowsBeside(at, x);
    const float* const row = &x[at.here];
    const float* const right_side = kResidual ? b + at.here : nullptr;
    const float* const d = kResidual ? diagonal + at.here : nullptr;
    float* const result = &out[at.here];
    const auto value = [&](int i, float left, float right) {
      const float laplacian =
          per_h2 * (6.0F * row[i] - (below[i] + above[i]) - (before[i] + behind[i]) - (left + right));
      if constexpr (kResidual) {
        return right_side[i] - laplacian - d[i] * row[i];
      } else {
        return laplacian;
      }
    };
    result[0] = value(0, row[0], row[1]);
    for (int i = 1; i + 1 < nx; ++i) {
      result[i] = value(i, row[i - 1], row[i + 1]);
    }
    result[nx - 1] = value(nx - 1, row[nx - 2], row[nx - 1]);
  });
}

/// Full weighting along one line of the fine grid around fine node 2i: ¼ ½ ¼, what lies outside counting as
/// nothing.
void restrict_to(const NodeGrid& fine, const std::vector<float>& from, const NodeGrid& coarse,
                 std::vector<float>& to) {
  for_rows(coarse, [&](int y, int z) {
    float* const out = &to[coarse.index(0, y, z)];
    std::fill_n(out, coarse.nx, 0.0F);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const int fy = 2 * y + dy;
        const int fz = 2 * z + dz;
        if (fy < 0 || fz < 0 || fy >= fine.ny || fz >= fine.nz) {
          continue;
        }
        const float weight = (dy == 0 ? 0.5F : 0.25F) * (dz == 0 ? 0.5F : 0.25F);
        const float* const row = &from[fine.index(0, fy, fz)];
        out[0] += weight * (0.5F * row[0] + 0.25F * row[1]);
        for (int x = 1; x + 1 < coarse.nx; ++x) {
          out[x] += weight * (0.25F * (row[2 * x - 1] + row[2 * x + 1]) + 0.5F * row[2 * x]);
        }
        const int last = coarse.nx - 1;
        out[last] += weight * (0.5F * row[2 * last] + 0.25F * row[2 * last - 1]);
      }
    }
  });
}

/// Adds the trilinear interpolation of the coarse grid.
void prolong_add(const NodeGrid& coarse, const std::vector<float>& from, const NodeGrid& fine,
                 std::vector<float>& to) {
  for_rows(fine, [&](int y, int z) {
    const float* const a = &from[coarse.index(0, y / 2, z / 2)];
    const float* const b = &from[coarse.index(0, (y + 1) / 2, z / 2)];
    const float* const c = &from[coarse.index(0, y / 2, (z + 1) / 2)];
    const float* const d = &from[coarse.index(0, (y + 1) / 2, (z + 1) / 2)];
    float* const out = &to[fine.index(0, y, z)];
    float left = 0.25F * ((a[0] + b[0]) + (c[0] + d[0]));
    out[0] += left;
    for (int x = 1; x < coarse.nx; ++x) {
      const float right = 0.25F * ((a[x] + b[x]) + (c[x] + d[x]));
      out[2 * x - 1] += 0.5F * (left + right);
      out[2 * x] += right;
      left = right;
    }
  });
}

NodeGrid half(const NodeGrid& grid) {
  NodeGrid coarse = grid;
  coarse.cell_mm = 2 * grid.cell_mm;
  coarse.nx = (grid.nx + 1) / 2;
  coarse.ny = (grid.ny + 1) / 2;
  coarse.nz = (grid.nz + 1) / 2;
  return coarse;
}

bool halves(const NodeGrid& grid) {
  const auto odd = [](int n) { return n % 2 == 1 && n >= 5; };
  return odd(grid.nx) && odd(grid.ny) && odd(grid.nz) && std::max({grid.nx, grid.ny, grid.nz}) > kCoarsest;
}

}  // namespace

int Multigrid::rounded_up(int count) {
  int step = 1;
  while (step < 16 && count > 3 * step) {
    step *= 2;
  }
  return (std::max(count, 3) - 2) / step * step + step + 1;
}

Multigrid::Multigrid(const NodeGrid& grid, std::vector<float> diagonal) {
  levels_.push_back({grid, std::move(diagonal), {}, {}});
  while (halves(levels_.back().grid)) {
    const Level& fine = levels_.back();
    Level coarse{half(fine.grid), {}, {}, {}};
    coarse.diagonal.resize(coarse.grid.count());
    restrict_to(fine.grid, fine.diagonal, coarse.grid, coarse.diagonal);
    coarse.x.resize(coarse.grid.count());
    coarse.b.resize(coarse.grid.count());
    levels_.push_back(std::move(coarse));
  }
}

void Multigrid::solve_roughly(const std::vector<float>& b, std::vector<float>& x) {
  levels_[0].b = b;
  levels_[0].x.swap(x);
  cycle(0);
  levels_[0].x.swap(x);
}

void Multigrid::cycle(std::size_t k) {
  Level& level = levels_[k];
  std::fill(level.x.begin(), level.x.end(), 0.0F);
  const bool coarsest = k + 1 == levels_.size();
  const int sweeps = coarsest ? kCoarsestSweeps : 1;
  for (int i = 0; i < sweeps; ++i) {
    relax(level.grid, level.diagonal, level.b, level.x, 0);
    relax(level.grid, level.diagonal, level.b, level.x, 1);
  }
  if (!coarsest) {
    Level& coarse = levels_[k + 1];
    std::vector<float> residual(level.grid.count());
    laplacian_or_residual<true>(level.grid, level.diagonal.data(), level.b.data(), level.x, residual);
    restrict_to(level.grid, residual, coarse.grid, coarse.b);
    cycle(k + 1);
    prolong_add(coarse.grid, coarse.x, level.grid, level.x);
  }
  for (int i = 0; i < sweeps; ++i) {
    relax(level.grid, level.diagonal, level.b, level.x, 1);
    relax(level.grid, level.diagonal, level.b, level.x, 0);
  }
}

void apply_laplacian(const NodeGrid& grid, const std::vector<float>& x, std::vector<float>& out) {
  laplacian_or_residual<false>(grid, nullptr, nullptr, x, out);
}

}  // namespace dubsar
