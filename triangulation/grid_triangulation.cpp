// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/grid_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/grid_geometry.h"
#include "core/huge_pages.h"
#include "core/parallel.h"
#include "core/row_camera.h"
#include "triangulation/cell_codes.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::size_t kRowsPerChunk = 16;

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

/// is_mirrored() of the samples at point(i).
template <class Point>
bool most_are_mirrored(const GridSurface& surface, std::span<const std::uint8_t> keep, const Point& point) {
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
      const Vector3f p = point(keep[i00] != 0 ? i00 : i11);
      const Vector3f down = left ? Vector3f(point(i10) - point(i00)) : Vector3f(point(i11) - point(i01));
      const Vector3f along = top ? Vector3f(point(i01) - point(i00)) : Vector3f(point(i11) - point(i10));
      const float longest = static_cast<float>(2.0 * surface.spacing_mm);
      if (std::max(down.squaredNorm(), along.squaredNorm()) > longest * longest) {
        continue;
      }
      votes += down.cross(along).dot(camera.from(p)) < 0 ? 1 : -1;
    }
  }
  return votes > 0;
}

/// Writes the triangles of a grid's cells: each row its vertices and faces where those of the rows before it
/// end.
struct GridMesher {
  const RangeGrid& grid;
  GridSurface surface;  ///< the grid's layout and normals; points are asked of the grid itself
  bool mirrored = false;
  std::vector<std::uint8_t> cells{};
  /// 1 where a triangle may have the sample; count_row() leaves those that one has.
  std::vector<std::uint8_t> used{};

  [[nodiscard]] Mesh mesh();

 private:
  struct RowCounts {
    std::size_t vertices = 0, faces = 0;
  };
  RowCounts count_row(int row);
  void write_vertices(int row, std::size_t at, std::span<std::uint32_t> vertex_of, Mesh& mesh) const;
  void write_faces(int row, std::size_t at, std::span<const std::uint32_t> vertex_of, Mesh& mesh) const;
  [[nodiscard]] Vector3f normal_of_triangles(int row, int col) const;
};

GridMesher::RowCounts GridMesher::count_row(int row) {
  RowCounts counts;
  for (int col = 0; col < grid.cols; ++col) {
    const std::size_t i = surface.index(row, col);
    const std::uint8_t cell = cells[i];
    counts.faces += static_cast<std::size_t>(((cell >> 1) & 1) + ((cell >> 2) & 1));
    if (used[i] != 0 && (cell & (kCellFirst | kCellSecond)) != (kCellFirst | kCellSecond)) {
      used[i] = 0;
      for_each_triangle_at(surface, cells, row, col, [&](const std::array<std::size_t, 3>&) { used[i] = 1; });
    }
    counts.vertices += used[i];
  }
  return counts;
}

Vector3f GridMesher::normal_of_triangles(int row, int col) const {
  Vector3f n = Vector3f::Zero();
  for_each_triangle_at(surface, cells, row, col, [&](const std::array<std::size_t, 3>& t) {
    n += (grid.point(t[1]) - grid.point(t[0])).cross(grid.point(t[2]) - grid.point(t[0]));
  });
  return n * ((mirrored ? -1.0F : 1.0F) / std::max(n.norm(), std::numeric_limits<float>::min()));
}

void GridMesher::write_vertices(int row, std::size_t at, std::span<std::uint32_t> vertex_of,
                                Mesh& mesh) const {
  for (int col = 0; col < grid.cols; ++col) {
    const std::size_t i = surface.index(row, col);
    if (used[i] == 0) {
      continue;
    }
    vertex_of[i] = static_cast<std::uint32_t>(at);
    mesh.positions[at] = grid.point(i);
    // Without a neighbour along the row or the column a sample has none of its own.
    const Vector3f& n = surface.normals[i];
    mesh.normals[at++] = n == Vector3f::Zero() ? normal_of_triangles(row, col) : n;
  }
}

void GridMesher::write_faces(int row, std::size_t at, std::span<const std::uint32_t> vertex_of,
                             Mesh& mesh) const {
  for (int col = 0; col + 1 < grid.cols; ++col) {
    const std::uint8_t cell = cells[surface.index(row, col)];
    for (int which = 0; cell != 0 && which < 2; ++which) {
      if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
        const auto f = cell_triangle(surface, row, col, cell, which);
        mesh.faces[at++] = {vertex_of[f[0]], vertex_of[f[mirrored ? 2 : 1]], vertex_of[f[mirrored ? 1 : 2]]};
      }
    }
  }
}

Mesh GridMesher::mesh() {
  const auto rows = static_cast<std::size_t>(grid.rows);
  const auto for_each_row = [&](const auto& body) { parallel_for_each_index(rows, body, kRowsPerChunk); };
  std::vector<RowCounts> before(rows + 1);
  for_each_row([&](std::size_t r) { before[r + 1] = count_row(static_cast<int>(r)); });
  for (std::size_t r = 0; r < rows; ++r) {
    before[r + 1].vertices += before[r].vertices;
    before[r + 1].faces += before[r].faces;
  }
  Mesh mesh;
  resize_in_huge_pages(mesh.faces, before.back().faces);
  resize_in_huge_pages(mesh.positions, before.back().vertices);
  resize_in_huge_pages(mesh.normals, before.back().vertices);
  std::vector<std::uint32_t> vertex_of(grid.size());
  for_each_row(
      [&](std::size_t r) { write_vertices(static_cast<int>(r), before[r].vertices, vertex_of, mesh); });
  for_each_row([&](std::size_t r) { write_faces(static_cast<int>(r), before[r].faces, vertex_of, mesh); });
  return mesh;
}

}  // namespace

bool is_mirrored(const GridSurface& surface, std::span<const std::uint8_t> keep) {
  return most_are_mirrored(surface, keep, [&](std::size_t i) { return surface.points[i]; });
}

std::vector<std::uint8_t> corners_of_cells(std::span<const std::uint8_t> cells, int rows, int cols) {
  static_assert(kCellAntidiagonal == 1 && kCellFirst == 2 && kCellSecond == 4);
  std::vector<std::uint8_t> used(cells.size(), 0);
  const auto width = static_cast<std::size_t>(cols);
  parallel_for_each_index(
      static_cast<std::size_t>(rows),
      [&](std::size_t row) {
        // The last cell of each row and the last row of cells are none: what lies before a row's first is
        // none.
        const std::uint8_t* const below = cells.data() + row * width;
        const std::uint8_t* const above = row > 0 ? below - width : below;
        const int has_above = row > 0 ? 1 : 0;
        std::uint8_t* const out = used.data() + row * width;
        const auto use = [&](std::size_t c, std::size_t before) {
          const int here = below[c];                     // its corner 00 is the sample
          const int left = below[before];                // 01
          const int over = has_above * above[c];         // 10
          const int aslant = has_above * above[before];  // 11
          const int by_here = (here >> 1) | ((here >> 2) & ~here);
          const int by_left = (left >> 2) | ((left >> 1) & left);
          const int by_over = (over >> 1) | ((over >> 2) & over);
          const int by_aslant = (aslant >> 2) | ((aslant >> 1) & ~aslant);
          out[c] = static_cast<std::uint8_t>((by_here | by_left | by_over | by_aslant) & 1);
        };
        if (width > 0) {
          use(0, width - 1);
        }
        for (std::size_t c = 1; c < width; ++c) {
          use(c, c - 1);
        }
      },
      kRowsPerChunk);
  return used;
}

std::vector<std::uint8_t> triangulate_cells(const GridSurface& surface, std::span<const std::uint8_t> keep,
                                            bool mirrored, const GridTriangulationOptions& options) {
  std::vector<std::uint8_t> cells(keep.size(), 0);
  if (surface.rows < 2 || surface.cols < 2) {
    return cells;
  }
  const TriangleTest good(surface.spacing_mm, mirrored, options);
  parallel_for_each_index(
      static_cast<std::size_t>(surface.rows - 1),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        cell_codes(surface, keep, row, 0, surface.cols - 1, RowCamera(surface.view, row), good,
                   cells.data() + surface.index(row, 0));
      },
      kRowsPerChunk);
  return cells;
}

void triangulate_cells_anew(const GridSurface& surface, std::span<const std::uint8_t> keep, bool mirrored,
                            const GridTriangulationOptions& options, std::span<const std::uint8_t> only,
                            std::span<std::uint8_t> cells) {
  const TriangleTest good(surface.spacing_mm, mirrored, options);
  constexpr int kStretch = 64;
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(surface.rows - 1, 0)),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        const RowCamera camera(surface.view, row);
        std::array<std::uint8_t, kStretch> codes{};
        for (int col = 0; col + 1 < surface.cols; col += kStretch) {
          const int count = std::min(surface.cols - 1 - col, kStretch);
          const std::size_t first = surface.index(row, col);
          const auto asked = only.subspan(first, static_cast<std::size_t>(count));
          if (std::ranges::all_of(asked, [](std::uint8_t one) { return one == 0; })) {
            continue;
          }
          cell_codes(surface, keep, row, col, count, camera, good, codes.data());
          for (std::size_t c = 0; c < asked.size(); ++c) {
            cells[first + c] = asked[c] != 0 ? codes[c] : cells[first + c];
          }
        }
      },
      kRowsPerChunk);
}

Mesh triangulate_grid(const RangeGrid& grid, const SampleFlags& flags,
                      const GridTriangulationOptions& options) {
  if (grid.rows < 2 || grid.cols < 2 || !(grid.spacing_mm > 0)) {
    return {};
  }
  const GridGeometry geometry = grid_geometry(grid);
  std::vector<std::uint8_t> keep(grid.size());
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        keep[i] =
            grid.valid[i] != 0 && grid.point(i).allFinite() && (flags.empty() || is_unflagged(flags[i]));
      },
      4096);
  GridMesher mesher{grid, {grid.rows, grid.cols, grid.spacing_mm, {}, geometry.normals, grid.view}};
  mesher.mirrored = most_are_mirrored(mesher.surface, keep, [&](std::size_t i) { return grid.point(i); });
  mesher.cells.resize(grid.size());
  const TriangleTest good(grid.spacing_mm, mesher.mirrored, options);
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows - 1),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        cell_codes(GridSamples{&grid, geometry.normals}, keep, row, RowCamera(grid.view, row), good,
                   mesher.cells.data() + grid.index(row, 0));
      },
      kRowsPerChunk);
  mesher.used = std::move(keep);
  return mesher.mesh();
}

}  // namespace dubsar
