// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/ownership.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
constexpr std::size_t kGrain = 2048;

/// Mean of the four nodes around a sample, those that hold samples.
class NodeInterpolation {
 public:
  explicit NodeInterpolation(const StitchSurface& s) : s_(&s) {}
  [[nodiscard]] float operator()(const std::vector<float>& values, int row, int col) const {
    const Lattice& lattice = s_->lattice;
    constexpr float kSide = Lattice::kNodeSide;
    const float y = (static_cast<float>(row) + 0.5F) / kSide - 0.5F;
    const float x = (static_cast<float>(col) + 0.5F) / kSide - 0.5F;
    const int row_lo = static_cast<int>(std::floor(y));
    const int col_lo = static_cast<int>(std::floor(x));
    float sum = 0;
    float weights = 0;
    for (int r = row_lo; r <= row_lo + 1; ++r) {
      for (int c = col_lo; c <= col_lo + 1; ++c) {
        if (r < 0 || c < 0 || r >= lattice.node_rows || c >= lattice.node_cols) {
          continue;
        }
        const std::size_t node = lattice.node(r, c);
        if (s_->node_sample[node] >= 0) {
          const float w =
              (1.0F - std::abs(y - static_cast<float>(r))) * (1.0F - std::abs(x - static_cast<float>(c)));
          sum += w * values[node];
          weights += w;
        }
      }
    }
    return weights > 0 ? sum / weights : 0.0F;
  }

 private:
  const StitchSurface* s_;
};

/// Takes away patches (kept samples around cells with triangles) of fewer than `least` samples, of those that
/// hold one of the samples with starts != 0.
void remove_specks(std::vector<std::uint8_t>& kept, const std::vector<std::uint8_t>& cells,
                   const std::vector<std::uint8_t>& starts, const Lattice& grid, int least) {
  std::vector<std::uint8_t> seen(kept.size(), 0);
  std::vector<std::size_t> patch;
  const auto width = static_cast<std::size_t>(grid.cols);
  const auto visit_cell = [&](std::size_t cell) {
    if ((cells[cell] & kBoth) == 0) {
      return;
    }
    for (const std::size_t i : {cell, cell + 1, cell + width, cell + width + 1}) {
      if (kept[i] != 0 && seen[i] == 0) {
        seen[i] = 1;
        patch.push_back(i);
      }
    }
  };
  for (std::size_t start = 0; start < kept.size(); ++start) {
    if (kept[start] == 0 || starts[start] == 0 || seen[start] != 0) {
      continue;
    }
    patch.assign(1, start);
    seen[start] = 1;
    for (std::size_t at = 0; at < patch.size(); ++at) {
      const std::size_t i = patch[at];
      const std::size_t col = i % width;
      if (i >= width && col > 0) {
        visit_cell(i - width - 1);
      }
      if (i >= width && col + 1 < width) {
        visit_cell(i - width);
      }
      if (i + width < kept.size() && col > 0) {
        visit_cell(i - 1);
      }
      if (i + width < kept.size() && col + 1 < width) {
        visit_cell(i);
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

  Window(const OwnedScan& other, std::int64_t centre, int radius)
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

/// By node: which of a scan's pairs keep something that samples of the node may have to do with: 1 near it, 2
/// right where it is.
struct Contest {
  std::vector<std::vector<std::uint8_t>> by_pair;
  std::vector<std::uint8_t> any;
};

/// True when sample i lies within the clearance of, or inside, what another scan keeps.
bool is_taken(const std::vector<OwnedScan>& scans, std::size_t self, std::size_t i, const Contest& contest,
              double clearance_factor, const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const Vector3f& p =
      scan.fused->slot[i] == FusedSamples::kNone ? scan.surface->points[i] : scan.fused->point(i);
  const std::size_t node = scan.surface->lattice.node_of(i);
  const auto is_taken_by = [&](std::size_t k) {
    const OwnedScan& other = scans[scan.other[k]];
    const std::int32_t start = pair_start(*scan.surface, node, *scan.pairs[k]);
    const std::int64_t j = start < 0 ? -1 : pair_of(*scan.surface, i, start, *other.surface, *scan.pairs[k]);
    if (j < 0 || other.near_kept[static_cast<std::size_t>(j)] == 0) {
      return false;
    }
    if (other.near_kept[static_cast<std::size_t>(j)] == kAllAroundKept) {
      return true;
    }
    const Window window(other, j, options.look_around_samples);
    const auto clearance =
        static_cast<float>(clearance_factor * std::max(scan.surface->spacing_mm, other.surface->spacing_mm));
    bool taken = false;
    const Vector3f& n = other.surface->normals[static_cast<std::size_t>(j)];
    for (int r = window.row_lo; r <= window.row_hi && !taken; ++r) {
      for (int c = window.col_lo; c <= window.col_hi && !taken; ++c) {
        const std::size_t q = window.g.index(r, c);
        if (other.kept[q] == 0) {
          continue;
        }
        const Vector3f d = other.fused->point(q) - p;
        const float along = d.dot(n);
        taken = d.squaredNorm() - along * along < clearance * clearance;
      }
    }
    if (!taken) {
      const Plane plane(p, n);
      window.for_each_triangle([&](const std::array<std::size_t, 3>& t) {
        taken = taken || inside(Vector2f::Zero(), plane(other.fused->point(t[0])),
                                plane(other.fused->point(t[1])), plane(other.fused->point(t[2])));
      });
    }
    return taken;
  };
  // First those that are likeliest to say yes.
  for (const std::uint8_t nearness : {2, 1}) {
    for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
      if (contest.by_pair[k][node] == nearness && is_taken_by(k)) {
        return true;
      }
    }
  }
  return false;
}

/// True when a triangle of another scan's patch meets the triangle abc of this one, seen along its normal.
bool meets_another(const std::vector<OwnedScan>& scans, std::size_t self, std::span<const Vector3f> points,
                   const std::array<std::size_t, 3>& t, const Contest& contest,
                   const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const std::size_t node = scan.surface->lattice.node_of(t[0]);
  for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
    const OwnedScan& other = scans[scan.other[k]];
    if (contest.by_pair[k][node] == 0) {
      continue;
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t start =
          pair_start(*scan.surface, scan.surface->lattice.node_of(t[corner]), *scan.pairs[k]);
      const std::int64_t j =
          start < 0 ? -1 : pair_of(*scan.surface, t[corner], start, *other.surface, *scan.pairs[k]);
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
        if (meets || std::abs(n.dot(other.fused->point(o[0]) - points[t[0]])) > near_mm) {
          return;
        }
        const Vector2f d = plane(other.fused->point(o[0]));
        const Vector2f e = plane(other.fused->point(o[1]));
        const Vector2f f = plane(other.fused->point(o[2]));
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
std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marks, int height, int width, int radius) {
  std::vector<std::uint8_t> along(marks.size(), 0);
  std::vector<std::uint8_t> out(marks.size(), 0);
  const auto rows = static_cast<std::size_t>(height);
  const auto cols = static_cast<std::size_t>(width);
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

/// Marks samples all around which triangles are kept: nothing that pairs with one lies outside the patch.
void mark_within(OwnedScan& scan) {
  const auto width = static_cast<std::size_t>(scan.surface->lattice.cols);
  const auto rows = static_cast<std::size_t>(scan.surface->lattice.rows);
  parallel_for_each_index(
      rows > 2 ? rows - 2 : 0,
      [&](std::size_t above) {
        for (std::size_t i = (above + 1) * width + 1; i + 1 < (above + 2) * width; ++i) {
          const int all =
              scan.cells[i] & scan.cells[i - 1] & scan.cells[i - width] & scan.cells[i - width - 1];
          if ((all & kBoth) == kBoth) {
            scan.near_kept[i] = kAllAroundKept;
          }
        }
      },
      16);
}

/// By node: how much of its block is kept.
void count_kept(OwnedScan& scan) {
  const Lattice& lattice = scan.surface->lattice;
  scan.some_kept.assign(lattice.size(), 0);
  scan.all_kept.assign(lattice.size(), 0);
  parallel_for_each_index(
      lattice.size(),
      [&](std::size_t node) {
        bool some = false;
        bool all = true;
        lattice.for_each_sample(node, [&](std::size_t i) {
          some = some || scan.kept[i] != 0;
          all = all && scan.kept[i] != 0;
        });
        scan.some_kept[node] = some ? 1 : 0;
        scan.all_kept[node] = all ? 1 : 0;
      },
      1024);
}

/// Nodes of another scan within which the pairs of one node's samples lie.
int reach_nodes(const StitchSurface& s, const StitchSurface& other) {
  return 1 + static_cast<int>(std::ceil(s.spacing_mm / other.spacing_mm));
}

Contest contest_of(const std::vector<OwnedScan>& scans, std::size_t self) {
  const OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  Contest contest;
  contest.any.assign(lattice.size(), 0);
  for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
    const OwnedScan& other = scans[scan.other[k]];
    const Lattice& theirs = other.surface->lattice;
    const int radius = reach_nodes(*scan.surface, *other.surface);
    std::vector<std::uint8_t>& mine = contest.by_pair.emplace_back(lattice.size(), std::uint8_t{0});
    if (other.some_kept.empty()) {
      continue;
    }
    parallel_for_each_index(
        lattice.size(),
        [&](std::size_t node) {
          const std::int32_t j = scan.pairs[k]->match[node];
          mine[node] = j >= 0 && theirs.any_within(theirs.node_of(static_cast<std::size_t>(j)), radius,
                                                   [&](std::size_t n) { return other.some_kept[n] != 0; })
                           ? 1
                           : 0;
        },
        1024);
    // Samples of nodes without a pair of their own go by those beside them, and so do cells.
    mine = dilated(mine, lattice.node_rows, lattice.node_cols, 2);
    for (std::size_t node = 0; node < mine.size(); ++node) {
      contest.any[node] |= mine[node];
      const std::int32_t j = scan.pairs[k]->match[node];
      mine[node] += j >= 0 && other.some_kept[theirs.node_of(static_cast<std::size_t>(j))] != 0 ? 1 : 0;
    }
  }
  return contest;
}

/// Gives a scan the samples `fresh` besides those that it keeps: triangles between them that meet no other
/// patch; then the samples they use.
void add_samples(std::vector<OwnedScan>& scans, std::size_t self, std::vector<std::uint8_t> fresh,
                 const Contest& contest, const GridTriangulationOptions& grid,
                 const OwnershipOptions& options, int least_patch) {
  OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  GridSurface g = scan.surface->surface();
  std::vector<Vector3f> points = scan.surface->points;
  for (std::size_t slot = 0; slot < scan.fused->samples.size(); ++slot) {
    points[scan.fused->samples[slot]] = scan.fused->points[slot];
  }
  g.points = points;
  std::vector<std::uint8_t> kept = std::move(scan.kept);
  std::vector<std::uint8_t> cells = std::move(scan.cells);
  kept.resize(fresh.size(), 0);
  cells.resize(fresh.size(), 0);
  // A cell is at stake when one of its corners is new.
  std::vector<std::uint8_t> anew(fresh.size(), 0);
  const auto width = static_cast<std::size_t>(g.cols);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    kept[i] |= fresh[i];
    anew[i] =
        i + width + 1 < fresh.size() ? fresh[i] | fresh[i + 1] | fresh[i + width] | fresh[i + width + 1] : 0;
  }
  triangulate_cells_anew(g, kept, scan.surface->mirrored, grid, anew, cells);
  parallel_for_each_index(
      contest.any.size(),
      [&](std::size_t node) {
        if (contest.any[node] == 0) {
          return;
        }
        lattice.for_each_sample(node, [&](std::size_t i) {
          if (anew[i] == 0) {
            return;
          }
          std::uint8_t& cell = cells[i];
          const int row = scan.surface->scan.grid->row_of(i);
          const int col = scan.surface->scan.grid->col_of(i);
          for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
            const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
            if ((cell & bit) != 0 &&
                meets_another(scans, self, points, cell_triangle(g, row, col, cell, which), contest,
                              options)) {
              cell = static_cast<std::uint8_t>(cell & ~bit);
            }
          }
        });
      },
      64);
  remove_specks(kept, cells, fresh, lattice, least_patch);
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
  scan.near_kept = dilated(scan.kept, g.rows, g.cols, options.look_around_samples);
  mark_within(scan);
  count_kept(scan);
}

/// Samples that nobody keeps, nor lies over.
std::vector<std::uint32_t> uncovered_samples(const std::vector<OwnedScan>& scans, std::size_t self,
                                             const Contest& contest, const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  using Samples = std::vector<std::uint32_t>;
  Samples out = parallel_reduce_ordered(
      lattice.size(), 256, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        for (std::size_t node = begin; node < end; ++node) {
          if (scan.surface->node_sample[node] < 0 || scan.all_kept[node] != 0) {
            continue;
          }
          bool covered = false;
          for (std::size_t k = 0; k < scan.pairs.size() && !covered; ++k) {
            const OwnedScan& other = scans[scan.other[k]];
            const Lattice& theirs = other.surface->lattice;
            const std::int32_t j = scan.pairs[k]->match[node];
            covered = j >= 0 && !theirs.any_within(theirs.node_of(static_cast<std::size_t>(j)),
                                                   reach_nodes(*scan.surface, *other.surface),
                                                   [&](std::size_t n) { return other.all_kept[n] == 0; });
          }
          if (covered) {
            continue;
          }
          lattice.for_each_sample(node, [&](std::size_t i) {
            if (scan.surface->usable[i] != 0 && scan.kept[i] == 0 &&
                !is_taken(scans, self, i, contest, options.clearance_factor, options)) {
              found.push_back(static_cast<std::uint32_t>(i));
            }
          });
        }
        return found;
      },
      [](Samples& total, const Samples& part) { total.insert(total.end(), part.begin(), part.end()); });
  return out;
}

}  // namespace

std::vector<std::uint8_t> wanted_samples(const std::vector<OwnedScan>& scans, std::size_t self,
                                         const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const StitchSurface& s = *scan.surface;
  const Lattice& lattice = s.lattice;
  std::vector<float> wanted(lattice.size(), 0);
  std::vector<std::uint8_t> seen(lattice.size(), 0);
  parallel_chunks(wanted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (s.node_sample[node] < 0) {
        continue;
      }
      bool best = true;
      for (std::size_t k = 0; best && k < scan.pairs.size(); ++k) {
        const std::int32_t j = scan.pairs[k]->match[node];
        if (j >= 0) {
          const StitchSurface& other = *scans[scan.other[k]].surface;
          const float theirs = other.score[other.lattice.node_of(static_cast<std::size_t>(j))];
          best = s.score[node] > theirs || (s.score[node] == theirs && self < scan.other[k]);
        }
      }
      seen[node] = 1;
      wanted[node] = best ? 1.0F : 0.0F;
    }
  });
  box_mean(wanted, seen, lattice.node_rows, lattice.node_cols,
           options.majority_radius_samples / Lattice::kNodeSide);
  const NodeInterpolation at(s);
  std::vector<std::uint8_t> out(s.points.size(), 0);
  parallel_for_each_index(
      static_cast<std::size_t>(lattice.rows),
      [&](std::size_t row) {
        for (int col = 0; col < lattice.cols; ++col) {
          const std::size_t i = row * static_cast<std::size_t>(lattice.cols) + static_cast<std::size_t>(col);
          out[i] = s.usable[i] != 0 && at(wanted, static_cast<int>(row), col) > 0.5F ? 1 : 0;
        }
      },
      16);
  return out;
}

bool assign_owners(std::vector<OwnedScan>& scans, const GridTriangulationOptions& grid,
                   const OwnershipOptions& options, const JobContext& job) {
  for (OwnedScan& scan : scans) {
    scan.kept.clear();
    scan.cells.clear();
    scan.near_kept.clear();
    scan.some_kept.clear();
    scan.all_kept.clear();
  }
  const double steps = 2.0 * static_cast<double>(scans.size());
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("assign primary scans", static_cast<double>(self) / steps);
    const Contest contest = contest_of(scans, self);
    std::vector<std::uint8_t> fresh = *scans[self].wanted;
    parallel_for_each_index(
        contest.any.size(),
        [&](std::size_t node) {
          if (contest.any[node] != 0) {
            scans[self].surface->lattice.for_each_sample(node, [&](std::size_t i) {
              fresh[i] =
                  fresh[i] != 0 && !is_taken(scans, self, i, contest, options.clearance_factor, options) ? 1
                                                                                                         : 0;
            });
          }
        },
        64);
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_wanted_patch_samples);
  }
  // What nobody keeps goes to the first scan that has it.
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("cover what is left", static_cast<double>(self + scans.size()) / steps);
    OwnedScan& scan = scans[self];
    const Contest contest = contest_of(scans, self);
    const std::vector<std::uint32_t> uncovered = uncovered_samples(scans, self, contest, options);
    if (uncovered.empty()) {
      continue;
    }
    std::vector<std::uint32_t> unfused;
    std::vector<std::uint8_t> fresh(scan.kept.size(), 0);
    for (const std::uint32_t i : uncovered) {
      fresh[i] = 1;
      if (scan.fused->slot[i] == FusedSamples::kNone) {
        unfused.push_back(i);
      }
    }
    scan.fuse(unfused);
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_patch_samples);
  }
  return true;
}

}  // namespace dubsar
