// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/grid_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/grid_geometry.h"
#include "core/parallel.h"
#include "core/row_camera.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::size_t kRowsPerChunk = 16;

/// The tests a triangle has to pass, with all constants of the grid at hand.
struct TriangleTest {
  float max_edge2 = 0;
  float min_facing2 = 0;
  float min_shape2 = 0;
  float sign = 1;

  [[nodiscard]] bool operator()(const Vector3f& ab, const Vector3f& ac, float ab2, float bc2, float ca2,
                                const Vector3f& to_camera) const {
    const float longest2 = std::max({ab2, bc2, ca2});
    const Vector3f n = ab.cross(ac);
    const float n2 = n.squaredNorm();
    const float facing = sign * n.dot(to_camera);
    return longest2 <= max_edge2 && n2 > min_shape2 * longest2 * longest2 && facing > 0 &&
           facing * facing > min_facing2 * n2 * to_camera.squaredNorm();
  }
};

/// Which diagonal keeps the ridge: true for 01-10. Gradients are compared by normals: the change of gradient
/// along a diagonal grows with the angle between the normals at its ends.
bool prefers_antidiagonal(const GridSurface& s, std::size_t i00, std::size_t i01, std::size_t i10,
                          std::size_t i11, float main2, float anti2) {
  const float along_main = s.normals[i00].dot(s.normals[i11]);
  const float along_anti = s.normals[i01].dot(s.normals[i10]);
  // Below this the two agree to within rounding, and the shorter one makes the better triangles.
  constexpr float kTie = 1e-6F;
  if (std::abs(along_main - along_anti) > kTie) {
    return along_anti > along_main;
  }
  return anti2 < main2;
}

std::uint8_t cell_code(const GridSurface& s, std::span<const std::uint8_t> keep, int row, int col,
                       const RowCamera& camera, const TriangleTest& good) {
  const std::size_t i00 = s.index(row, col);
  const std::size_t i01 = i00 + 1;
  const std::size_t i10 = i00 + static_cast<std::size_t>(s.cols);
  const std::size_t i11 = i10 + 1;
  const bool k00 = keep[i00] != 0;
  const bool k01 = keep[i01] != 0;
  const bool k10 = keep[i10] != 0;
  const bool k11 = keep[i11] != 0;
  if (static_cast<int>(k00) + static_cast<int>(k01) + static_cast<int>(k10) + static_cast<int>(k11) < 3) {
    return 0;
  }
  const Vector3f& p00 = s.points[i00];
  const Vector3f& p01 = s.points[i01];
  const Vector3f& p10 = s.points[i10];
  const Vector3f& p11 = s.points[i11];
  const Vector3f to_camera = camera.from(k00 ? p00 : p11);
  const Vector3f top = p01 - p00;
  const Vector3f left = p10 - p00;
  const Vector3f bottom = p11 - p10;
  const Vector3f right = p11 - p01;
  const Vector3f main = p11 - p00;
  const Vector3f anti = p01 - p10;
  const float top2 = top.squaredNorm();
  const float left2 = left.squaredNorm();
  const float bottom2 = bottom.squaredNorm();
  const float right2 = right.squaredNorm();
  const float main2 = main.squaredNorm();
  const float anti2 = anti.squaredNorm();
  const auto main_bits = [&]() -> std::uint8_t {
    const bool first = k00 && k10 && k11 && good(left, main, left2, bottom2, main2, to_camera);
    const bool second = k00 && k11 && k01 && good(main, top, main2, right2, top2, to_camera);
    return static_cast<std::uint8_t>((first ? kCellFirst : 0) | (second ? kCellSecond : 0));
  };
  const auto anti_bits = [&]() -> std::uint8_t {
    const bool first = k00 && k10 && k01 && good(left, top, left2, anti2, top2, to_camera);
    const bool second = k10 && k11 && k01 && good(bottom, anti, bottom2, right2, anti2, to_camera);
    const int bits = (first ? kCellFirst : 0) | (second ? kCellSecond : 0);
    return static_cast<std::uint8_t>(bits == 0 ? 0 : bits | kCellAntidiagonal);
  };
  const bool all = k00 && k01 && k10 && k11;
  const bool anti_first = all ? prefers_antidiagonal(s, i00, i01, i10, i11, main2, anti2) : !(k00 && k11);
  const std::uint8_t preferred = anti_first ? anti_bits() : main_bits();
  constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
  if ((preferred & kBoth) == kBoth || !all) {
    return preferred;
  }
  const std::uint8_t other = anti_first ? main_bits() : anti_bits();
  return (other & kBoth) == kBoth || preferred == 0 ? other : preferred;
}

/// Calls visit(triangle) for those of the four cells around a sample that have it as a corner.
template <class Visit>
void for_each_triangle_at(const GridSurface& s, const std::vector<std::uint8_t>& cells, int row, int col,
                          const Visit& visit) {
  const std::size_t i = s.index(row, col);
  for (int r = std::max(row - 1, 0); r <= std::min(row, s.rows - 2); ++r) {
    for (int c = std::max(col - 1, 0); c <= std::min(col, s.cols - 2); ++c) {
      const std::uint8_t cell = cells[s.index(r, c)];
      for (int which = 0; cell != 0 && which < 2; ++which) {
        if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
          const auto t = cell_triangle(s, r, c, cell, which);
          if (t[0] == i || t[1] == i || t[2] == i) {
            visit(t);
          }
        }
      }
    }
  }
}

TriangleTest make_test(const GridSurface& surface, bool mirrored, const GridTriangulationOptions& options) {
  const double max_edge = options.max_edge_factor * surface.spacing_mm;
  return {static_cast<float>(max_edge * max_edge),
          static_cast<float>(options.min_facing_cos * options.min_facing_cos),
          static_cast<float>(options.min_shape * options.min_shape), mirrored ? -1.0F : 1.0F};
}

}  // namespace

bool is_mirrored(const GridSurface& surface, std::span<const std::uint8_t> keep) {
  // A few thousand cells settle a vote; rows are skipped evenly on large grids.
  const int step = std::max(1, surface.rows / 128);
  long votes = 0;
  for (int row = 0; row + 1 < surface.rows; row += step) {
    const RowCamera camera(surface.view, row);
    for (int col = 0; col + 1 < surface.cols; ++col) {
      const std::size_t i00 = surface.index(row, col);
      const std::size_t i01 = i00 + 1;
      const std::size_t i10 = i00 + static_cast<std::size_t>(surface.cols);
      const std::size_t i11 = i10 + 1;
      const bool left = keep[i00] != 0 && keep[i10] != 0;
      const bool top = keep[i00] != 0 && keep[i01] != 0;
      // Three corners or more always hold a whole side either way.
      if ((!left && (keep[i01] == 0 || keep[i11] == 0)) || (!top && (keep[i10] == 0 || keep[i11] == 0))) {
        continue;
      }
      const Vector3f& p = surface.points[keep[i00] != 0 ? i00 : i11];
      const Vector3f down =
          left ? surface.points[i10] - surface.points[i00] : surface.points[i11] - surface.points[i01];
      const Vector3f along =
          top ? surface.points[i01] - surface.points[i00] : surface.points[i11] - surface.points[i10];
      const float longest = static_cast<float>(2.0 * surface.spacing_mm);
      if (std::max(down.squaredNorm(), along.squaredNorm()) > longest * longest) {
        continue;
      }
      votes += down.cross(along).dot(camera.from(p)) < 0 ? 1 : -1;
    }
  }
  return votes > 0;
}

std::vector<std::uint8_t> triangulate_cells(const GridSurface& surface, std::span<const std::uint8_t> keep,
                                            bool mirrored, const GridTriangulationOptions& options) {
  std::vector<std::uint8_t> cells(keep.size(), 0);
  if (surface.rows < 2 || surface.cols < 2) {
    return cells;
  }
  const TriangleTest good = make_test(surface, mirrored, options);
  parallel_for_each_index(
      static_cast<std::size_t>(surface.rows - 1),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        const RowCamera camera(surface.view, row);
        std::uint8_t* out = cells.data() + surface.index(row, 0);
        for (int col = 0; col + 1 < surface.cols; ++col) {
          out[col] = cell_code(surface, keep, row, col, camera, good);
        }
      },
      kRowsPerChunk);
  return cells;
}

void triangulate_cells_anew(const GridSurface& surface, std::span<const std::uint8_t> keep, bool mirrored,
                            const GridTriangulationOptions& options, std::span<const std::uint8_t> only,
                            std::span<std::uint8_t> cells) {
  const TriangleTest good = make_test(surface, mirrored, options);
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(surface.rows - 1, 0)),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        const RowCamera camera(surface.view, row);
        for (int col = 0; col + 1 < surface.cols; ++col) {
          const std::size_t cell = surface.index(row, col);
          if (only[cell] != 0) {
            cells[cell] = cell_code(surface, keep, row, col, camera, good);
          }
        }
      },
      kRowsPerChunk);
}

Mesh triangulate_grid(const RangeGrid& grid, const SampleFlags& flags,
                      const GridTriangulationOptions& options) {
  Mesh mesh;
  if (grid.rows < 2 || grid.cols < 2 || !(grid.spacing_mm > 0)) {
    return mesh;
  }
  const GridGeometry geometry = grid_geometry(grid);
  std::vector<Vector3f> points(grid.size());
  std::vector<std::uint8_t> keep(grid.size());
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        points[i] = grid.point(i);
        keep[i] = grid.valid[i] != 0 && points[i].allFinite() && (flags.empty() || is_unflagged(flags[i]));
      },
      4096);
  const GridSurface surface{grid.rows, grid.cols, grid.spacing_mm, points, geometry.normals, grid.view};
  const bool mirrored = is_mirrored(surface, keep);
  const std::vector<std::uint8_t> cells = triangulate_cells(surface, keep, mirrored, options);

  // Each row writes its vertices and faces where those of the rows before it end.
  const auto rows = static_cast<std::size_t>(grid.rows);
  std::vector<std::size_t> first_face(rows + 1, 0);
  std::vector<std::size_t> first_vertex(rows + 1, 0);
  std::vector<std::uint8_t>& used = keep;
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = surface.index(row, col);
          const std::uint8_t cell = cells[i];
          first_face[r + 1] += static_cast<std::size_t>(((cell >> 1) & 1) + ((cell >> 2) & 1));
          if (used[i] != 0 && (cell & (kCellFirst | kCellSecond)) != (kCellFirst | kCellSecond)) {
            used[i] = 0;
            for_each_triangle_at(surface, cells, row, col,
                                 [&](const std::array<std::size_t, 3>&) { used[i] = 1; });
          }
          first_vertex[r + 1] += used[i];
        }
      },
      kRowsPerChunk);
  for (std::size_t row = 0; row < rows; ++row) {
    first_face[row + 1] += first_face[row];
    first_vertex[row + 1] += first_vertex[row];
  }
  mesh.faces.resize(first_face.back());
  mesh.positions.resize(first_vertex.back());
  mesh.normals.resize(first_vertex.back());
  std::vector<std::uint32_t> vertex_of(grid.size());
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        std::size_t at = first_vertex[r];
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = surface.index(static_cast<int>(r), col);
          if (used[i] == 0) {
            continue;
          }
          vertex_of[i] = static_cast<std::uint32_t>(at);
          mesh.positions[at] = points[i];
          Vector3f n = geometry.normals[i];
          if (n.isZero()) {  // no neighbour along the row or the column: what its triangles say
            for_each_triangle_at(surface, cells, static_cast<int>(r), col,
                                 [&](const std::array<std::size_t, 3>& t) {
                                   n += (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
                                 });
            n *= (mirrored ? -1.0F : 1.0F) / std::max(n.norm(), std::numeric_limits<float>::min());
          }
          mesh.normals[at++] = n;
        }
      },
      kRowsPerChunk);
  parallel_for_each_index(
      rows - 1,
      [&](std::size_t r) {
        std::size_t at = first_face[r];
        for (int col = 0; col + 1 < grid.cols; ++col) {
          const std::uint8_t cell = cells[surface.index(static_cast<int>(r), col)];
          for (int which = 0; cell != 0 && which < 2; ++which) {
            if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
              const auto f = cell_triangle(surface, static_cast<int>(r), col, cell, which);
              mesh.faces[at++] = {vertex_of[f[0]], vertex_of[f[mirrored ? 2 : 1]],
                                  vertex_of[f[mirrored ? 1 : 2]]};
            }
          }
        }
      },
      kRowsPerChunk);
  return mesh;
}

}  // namespace dubsar
