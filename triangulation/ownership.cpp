// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/ownership.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
constexpr std::size_t kGrain = 2048;

/// 1 where this scan would be primary: no pair has a better score; of equals the lower id.
std::vector<std::uint8_t> wanted_samples(const std::vector<OwnedScan>& scans, std::size_t self, int radius) {
  const OwnedScan& scan = scans[self];
  const StitchSurface& s = *scan.surface;
  std::vector<float> wanted(s.points.size(), 0);
  parallel_chunks(wanted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      bool best = s.usable[i] != 0;
      for (std::size_t k = 0; best && k < scan.pairs.size(); ++k) {
        const std::int32_t j = scan.pairs[k]->match[i];
        if (j >= 0) {
          const float theirs = scans[scan.other[k]].surface->score[static_cast<std::size_t>(j)];
          best = s.score[i] > theirs || (s.score[i] == theirs && self < scan.other[k]);
        }
      }
      wanted[i] = best ? 1.0F : 0.0F;
    }
  });
  box_mean(wanted, s.usable, s.scan.grid->rows, s.scan.grid->cols, radius);
  std::vector<std::uint8_t> out(wanted.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = wanted[i] > 0.5F ? 1 : 0;
  }
  return out;
}

/// Takes away patches (kept samples around cells with triangles) of fewer than `least` samples.
void remove_specks(std::vector<std::uint8_t>& kept, const std::vector<std::uint8_t>& cells,
                   const GridSurface& g, int least) {
  std::vector<std::uint8_t> seen(kept.size(), 0);
  std::vector<std::size_t> patch;
  for (std::size_t start = 0; start < kept.size(); ++start) {
    if (kept[start] == 0 || seen[start] != 0) {
      continue;
    }
    patch.assign(1, start);
    seen[start] = 1;
    for (std::size_t at = 0; at < patch.size(); ++at) {
      const int row = static_cast<int>(patch[at] / static_cast<std::size_t>(g.cols));
      const int col = static_cast<int>(patch[at] % static_cast<std::size_t>(g.cols));
      for (int r = std::max(row - 1, 0); r <= std::min(row, g.rows - 2); ++r) {
        for (int c = std::max(col - 1, 0); c <= std::min(col, g.cols - 2); ++c) {
          const std::size_t cell = g.index(r, c);
          if ((cells[cell] & kBoth) == 0) {
            continue;
          }
          for (const std::size_t i : {cell, cell + 1, cell + static_cast<std::size_t>(g.cols),
                                      cell + static_cast<std::size_t>(g.cols) + 1}) {
            if (kept[i] != 0 && seen[i] == 0) {
              seen[i] = 1;
              patch.push_back(i);
            }
          }
        }
      }
    }
    if (patch.size() < static_cast<std::size_t>(least)) {
      for (const std::size_t i : patch) {
        kept[i] = 0;
      }
    }
  }
}

/// Leaves samples that no kept triangle uses.
void drop_unused(OwnedScan& scan, const GridSurface& g) {
  parallel_for_each_index(
      static_cast<std::size_t>(g.rows),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int col = 0; col < g.cols; ++col) {
          const std::size_t i = g.index(row, col);
          if (scan.kept[i] == 0) {
            continue;
          }
          bool used = false;
          for (int cr = std::max(row - 1, 0); cr <= std::min(row, g.rows - 2) && !used; ++cr) {
            for (int cc = std::max(col - 1, 0); cc <= std::min(col, g.cols - 2) && !used; ++cc) {
              const std::uint8_t cell = scan.cells[g.index(cr, cc)];
              for (int which = 0; which < 2 && !used; ++which) {
                if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
                  const auto t = cell_triangle(g, cr, cc, cell, which);
                  used = t[0] == i || t[1] == i || t[2] == i;
                }
              }
            }
          }
          // Rows of other chunks read `cells`, never `kept`.
          scan.kept[i] = used ? 1 : 0;
        }
      },
      16);
}

float cross2(const Vector2f& a, const Vector2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool inside(const Vector2f& p, const Vector2f& a, const Vector2f& b, const Vector2f& c) {
  const float u = cross2(b - a, p - a);
  const float v = cross2(c - b, p - b);
  const float w = cross2(a - c, p - c);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

bool cross(const Vector2f& a, const Vector2f& b, const Vector2f& c, const Vector2f& d) {
  return (cross2(b - a, c - a) > 0) != (cross2(b - a, d - a) > 0) &&
         (cross2(d - c, a - c) > 0) != (cross2(d - c, b - c) > 0);
}

/// A plane to compare in: that of the sample or triangle in question.
struct Plane {
  Vector3f origin, u, v;

  Plane(const Vector3f& at, const Vector3f& normal)
      : origin(at), u(normal.unitOrthogonal()), v(normal.cross(u)) {}
  [[nodiscard]] Vector2f operator()(const Vector3f& p) const {
    return {u.dot(p - origin), v.dot(p - origin)};
  }
};

/// The kept patch of another scan around one of its samples.
struct Window {
  const OwnedScan* scan;
  GridSurface g;
  int row_lo, row_hi, col_lo, col_hi;

  Window(const OwnedScan& other, std::int32_t centre, int radius)
      : scan(&other), g(other.surface->surface()) {
    const int row = other.surface->scan.grid->row_of(static_cast<std::size_t>(centre));
    const int col = other.surface->scan.grid->col_of(static_cast<std::size_t>(centre));
    row_lo = std::max(row - radius, 0);
    row_hi = std::min(row + radius, g.rows - 1);
    col_lo = std::max(col - radius, 0);
    col_hi = std::min(col + radius, g.cols - 1);
  }
  template <class Visit>
  void for_each_triangle(const Visit& visit) const {
    for (int r = row_lo; r < row_hi; ++r) {
      for (int c = col_lo; c < col_hi; ++c) {
        const std::uint8_t cell = scan->cells[g.index(r, c)];
        for (int which = 0; cell != 0 && which < 2; ++which) {
          if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
            visit(cell_triangle(g, r, c, cell, which));
          }
        }
      }
    }
  }
};

/// True when sample i lies within the clearance of, or inside, what another scan keeps.
bool is_taken(const std::vector<OwnedScan>& scans, std::size_t self, std::size_t i,
              const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const Vector3f& p = scan.fused->points[i];
  for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
    const OwnedScan& other = scans[scan.other[k]];
    const std::int32_t j = scan.pairs[k]->match[i];
    if (j < 0 || other.near_kept.empty() || other.near_kept[static_cast<std::size_t>(j)] == 0) {
      continue;
    }
    const Window window(other, j, options.look_around_samples);
    const auto clearance = static_cast<float>(options.clearance_factor *
                                              std::max(scan.surface->spacing_mm, other.surface->spacing_mm));
    bool taken = false;
    const Vector3f& n = other.surface->normals[static_cast<std::size_t>(j)];
    for (int r = window.row_lo; r <= window.row_hi && !taken; ++r) {
      for (int c = window.col_lo; c <= window.col_hi && !taken; ++c) {
        const std::size_t q = window.g.index(r, c);
        if (other.kept[q] == 0) {
          continue;
        }
        const Vector3f d = other.fused->points[q] - p;
        const float along = d.dot(n);
        taken = d.squaredNorm() - along * along < clearance * clearance;
      }
    }
    if (!taken) {
      const Plane plane(p, n);
      window.for_each_triangle([&](const std::array<std::size_t, 3>& t) {
        taken = taken || inside(Vector2f::Zero(), plane(other.fused->points[t[0]]),
                                plane(other.fused->points[t[1]]), plane(other.fused->points[t[2]]));
      });
    }
    if (taken) {
      return true;
    }
  }
  return false;
}

/// True when a triangle of another scan's patch meets the triangle abc of this one, seen along its normal.
bool meets_another(const std::vector<OwnedScan>& scans, std::size_t self, const std::array<std::size_t, 3>& t,
                   const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const std::vector<Vector3f>& points = scan.fused->points;
  for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
    const OwnedScan& other = scans[scan.other[k]];
    if (other.near_kept.empty()) {
      continue;
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t j = scan.pairs[k]->match[t[corner]];
      if (j < 0 || other.near_kept[static_cast<std::size_t>(j)] == 0) {
        continue;
      }
      const Window window(other, j, options.look_around_samples);
      const Vector3f n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).normalized();
      const Plane plane(points[t[0]], n);
      const Vector2f a = plane(points[t[0]]);
      const Vector2f b = plane(points[t[1]]);
      const Vector2f c = plane(points[t[2]]);
      const float near_mm = scan.pairs[k]->reach_mm;
      bool meets = false;
      window.for_each_triangle([&](const std::array<std::size_t, 3>& o) {
        if (meets || std::abs(n.dot(other.fused->points[o[0]] - points[t[0]])) > near_mm) {
          return;
        }
        const Vector2f d = plane(other.fused->points[o[0]]);
        const Vector2f e = plane(other.fused->points[o[1]]);
        const Vector2f f = plane(other.fused->points[o[2]]);
        meets = inside(d, a, b, c) || inside(a, d, e, f) || cross(a, b, d, e) || cross(a, b, e, f) ||
                cross(a, b, f, d) || cross(b, c, d, e) || cross(b, c, e, f) || cross(b, c, f, d) ||
                cross(c, a, d, e) || cross(c, a, e, f) || cross(c, a, f, d);
      });
      if (meets) {
        return true;
      }
    }
  }
  return false;
}

/// 1 within `radius` samples (a square) of a mark.
std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marks, const GridSurface& g, int radius) {
  std::vector<std::uint8_t> along(marks.size(), 0);
  std::vector<std::uint8_t> out(marks.size(), 0);
  const auto rows = static_cast<std::size_t>(g.rows);
  const auto cols = static_cast<std::size_t>(g.cols);
  const auto reach = static_cast<std::size_t>(std::max(radius, 0));
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        for (std::size_t c = 0; c < cols; ++c) {
          if (marks[r * cols + c] != 0) {
            const std::size_t begin = r * cols + (c > reach ? c - reach : 0);
            const std::size_t end = r * cols + std::min(c + reach + 1, cols);
            std::fill(along.begin() + static_cast<std::ptrdiff_t>(begin),
                      along.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
          }
        }
      },
      16);
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        for (std::size_t q = r > reach ? r - reach : 0; q < std::min(r + reach + 1, rows); ++q) {
          for (std::size_t c = 0; c < cols; ++c) {
            out[r * cols + c] |= along[q * cols + c];
          }
        }
      },
      16);
  return out;
}

/// Triangles between the kept samples that meet no other patch; then the samples they use.
void rebuild(std::vector<OwnedScan>& scans, std::size_t self, std::vector<std::uint8_t> kept,
             const GridTriangulationOptions& grid, const OwnershipOptions& options) {
  OwnedScan& scan = scans[self];
  GridSurface g = scan.surface->surface();
  g.points = scan.fused->points;
  std::vector<std::uint8_t> cells = triangulate_cells(g, kept, scan.surface->mirrored, grid);
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(g.rows - 1, 0)),
      [&](std::size_t r) {
        for (int col = 0; col + 1 < g.cols; ++col) {
          std::uint8_t& cell = cells[g.index(static_cast<int>(r), col)];
          for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
            const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
            if ((cell & bit) != 0 &&
                meets_another(scans, self, cell_triangle(g, static_cast<int>(r), col, cell, which),
                              options)) {
              cell = static_cast<std::uint8_t>(cell & ~bit);
            }
          }
        }
      },
      4);
  remove_specks(kept, cells, g, options.least_patch_samples);
  // Cells of removed specks lose their corners, so their triangles go too.
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(g.rows - 1, 0)),
      [&](std::size_t r) {
        for (int col = 0; col + 1 < g.cols; ++col) {
          std::uint8_t& cell = cells[g.index(static_cast<int>(r), col)];
          for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
            const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
            if ((cell & bit) != 0) {
              const auto t = cell_triangle(g, static_cast<int>(r), col, cell, which);
              if (kept[t[0]] == 0 || kept[t[1]] == 0 || kept[t[2]] == 0) {
                cell = static_cast<std::uint8_t>(cell & ~bit);
              }
            }
          }
        }
      },
      16);
  scan.kept = std::move(kept);
  scan.cells = std::move(cells);
  drop_unused(scan, g);
  scan.near_kept = dilated(scan.kept, g, options.look_around_samples);
}

}  // namespace

bool assign_owners(std::vector<OwnedScan>& scans, const GridTriangulationOptions& grid,
                   const OwnershipOptions& options, const JobContext& job) {
  for (OwnedScan& scan : scans) {
    scan.kept.clear();
    scan.cells.clear();
    scan.near_kept.clear();
  }
  const double steps = 2.0 * static_cast<double>(scans.size());
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("assign primary scans", static_cast<double>(self) / steps);
    std::vector<std::uint8_t> kept = wanted_samples(scans, self, options.majority_radius_samples);
    parallel_for_each_index(
        kept.size(),
        [&](std::size_t i) { kept[i] = kept[i] != 0 && !is_taken(scans, self, i, options) ? 1 : 0; }, kGrain);
    rebuild(scans, self, std::move(kept), grid, options);
  }
  // What nobody keeps goes to the first scan that has it.
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("assign primary scans", static_cast<double>(self + scans.size()) / steps);
    const OwnedScan& scan = scans[self];
    std::vector<std::uint8_t> kept = scan.kept;
    const bool grows = parallel_reduce_ordered(
        kept.size(), kGrain, false,
        [&](std::size_t begin, std::size_t end) {
          bool any = false;
          for (std::size_t i = begin; i < end; ++i) {
            if (scan.surface->usable[i] != 0 && kept[i] == 0 && !is_taken(scans, self, i, options)) {
              kept[i] = 1;
              any = true;
            }
          }
          return any;
        },
        [](bool& total, bool part) { total = total || part; });
    if (grows) {
      rebuild(scans, self, std::move(kept), grid, options);
    }
  }
  return true;
}

}  // namespace dubsar
