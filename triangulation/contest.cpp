// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/contest.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/dilated.h"
#include "core/parallel.h"
#include "triangulation/patch_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

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
  Vector3f origin, n, u, v;

  Plane(const Vector3f& at, const Vector3f& normal)
      : origin(at), n(normal), u(normal.unitOrthogonal()), v(normal.cross(u)) {}
  [[nodiscard]] Vector2f operator()(const Vector3f& p) const {
    return {u.dot(p - origin), v.dot(p - origin)};
  }
  [[nodiscard]] float height(const Vector3f& p) const { return n.dot(p - origin); }
};

/// The kept patch of another scan around one of its samples.
struct Window {
  static constexpr int kMostSide = 2 * kLookAroundSamples + 1 + 3;  ///< samples, of several in one

  const OwnedScan* scan;
  GridSurface g;
  int row_lo, row_hi, col_lo, col_hi;

  Window(const OwnedScan& other, std::int64_t centre) : scan(&other), g(other.surface->surface()) {
    const int row = other.surface->lattice.sample_row(static_cast<std::size_t>(centre));
    const int col = other.surface->lattice.sample_col(static_cast<std::size_t>(centre));
    row_lo = std::max(row - kLookAroundSamples, 0);
    row_hi = std::min(row + kLookAroundSamples, g.rows - 1);
    col_lo = std::max(col - kLookAroundSamples, 0);
    col_hi = std::min(col + kLookAroundSamples, g.cols - 1);
  }
  /// True when the other lies within or hardly beside it: then it is taken in.
  [[nodiscard]] bool take_in(const Window& near) {
    const int rows[] = {std::min(row_lo, near.row_lo), std::max(row_hi, near.row_hi)};
    const int cols[] = {std::min(col_lo, near.col_lo), std::max(col_hi, near.col_hi)};
    if (rows[1] - rows[0] >= kMostSide || cols[1] - cols[0] >= kMostSide) {
      return false;
    }
    row_lo = rows[0];
    row_hi = rows[1];
    col_lo = cols[0];
    col_hi = cols[1];
    return true;
  }
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(col_hi - col_lo + 1); }
  /// A sample's place among those of the window, row by row.
  [[nodiscard]] std::size_t place_of(int row, int col) const {
    return static_cast<std::size_t>(row - row_lo) * width() + static_cast<std::size_t>(col - col_lo);
  }
  /// Whether holds(triangle) for one of those within; its corners are places.
  template <class Holds>
  [[nodiscard]] bool any_triangle(const Holds& holds) const {
    for (int r = row_lo; r < row_hi; ++r) {
      for (int c = col_lo; c < col_hi; ++c) {
        const std::uint8_t cell = scan->cells[g.index(r, c)];
        if ((cell & (kCellFirst | kCellSecond)) == 0) {
          continue;
        }
        const std::size_t p00 = place_of(r, c), p10 = place_of(r + 1, c);
        const bool anti = (cell & kCellAntidiagonal) != 0;
        using Three = std::array<std::size_t, 3>;
        if (((cell & kCellFirst) != 0 && holds(Three{p00, p10, anti ? p00 + 1 : p10 + 1})) ||
            ((cell & kCellSecond) != 0 && holds(Three{anti ? p10 : p00, p10 + 1, p00 + 1}))) {
          return true;
        }
      }
    }
    return false;
  }
};

/// A window as it looks along the normal of a plane; places of samples that are not kept hold zeros.
struct FlatWindow {
  std::array<Vector2f, Window::kMostSide * Window::kMostSide> at;
  std::array<float, Window::kMostSide * Window::kMostSide> height_mm;

  FlatWindow(const Window& window, const Plane& plane) {
    at.fill(Vector2f::Zero());
    height_mm.fill(0);
    for (int r = window.row_lo; r <= window.row_hi; ++r) {
      for (int c = window.col_lo; c <= window.col_hi; ++c) {
        const std::size_t q = window.g.index(r, c);
        if (window.scan->kept[q] != 0) {
          const Vector3f p = window.scan->fused->point(q);
          at[window.place_of(r, c)] = plane(p);
          height_mm[window.place_of(r, c)] = std::abs(plane.height(p));
        }
      }
    }
  }
};

using FlatTriangle = std::array<Vector2f, 3>;

/// Whether a triangle of the window, not farther than `near_mm` above or below, meets t in the plane.
bool meets(const Window& window, const FlatTriangle& t, const Plane& plane, float near_mm) {
  const FlatWindow flat(window, plane);
  const Vector2f low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
  const Vector2f high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
  const Vector2f &a = t[0], &b = t[1], &c = t[2];
  return window.any_triangle([&](const std::array<std::size_t, 3>& o) {
    const Vector2f &d = flat.at[o[0]], &e = flat.at[o[1]], &f = flat.at[o[2]];
    if (flat.height_mm[o[0]] > near_mm || (d.cwiseMin(e).cwiseMin(f).array() > high.array()).any() ||
        (d.cwiseMax(e).cwiseMax(f).array() < low.array()).any()) {
      return false;
    }
    return inside(d, a, b, c) || inside(a, d, e, f) || cross(a, b, d, e) || cross(a, b, e, f) ||
           cross(a, b, f, d) || cross(b, c, d, e) || cross(b, c, e, f) || cross(b, c, f, d) ||
           cross(c, a, d, e) || cross(c, a, e, f) || cross(c, a, f, d);
  });
}

}  // namespace

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
    parallel_for_each_index(
        mine.size(),
        [&](std::size_t node) {
          contest.any[node] |= mine[node];
          const std::int32_t j = scan.pairs[k]->match[node];
          mine[node] += j >= 0 && other.some_kept[theirs.node_of(static_cast<std::size_t>(j))] != 0 ? 1 : 0;
        },
        1024);
  }
  return contest;
}

namespace {

constexpr int kNotAsked = -2;
constexpr int kAskedSide = Lattice::kNodeSide + 1;  ///< samples of a node, and those just after them
constexpr std::size_t kAsked = kAskedSide * kAskedSide;
constexpr std::size_t kStarts = 4;

}  // namespace

NodeContest::NodeContest(const std::vector<OwnedScan>& scans, std::size_t self, const Contest& contest,
                         const OwnershipOptions& options)
    : scans_(&scans),
      scan_(&scans[self]),
      contest_(&contest),
      options_(&options),
      starts_(scan_->pairs.size() * kStarts),
      start_known_(scan_->pairs.size() * kStarts),
      pair_(scan_->pairs.size() * kAsked) {}

void NodeContest::lay_out() {
  const Lattice& lattice = scan_->surface->lattice;
  is_laid_out_ = true;
  row_ = lattice.row_of(node_) * Lattice::kNodeSide;
  col_ = lattice.col_of(node_) * Lattice::kNodeSide;
  std::ranges::fill(start_known_, 0);
  std::ranges::fill(pair_, kNotAsked);
}

const StitchSurface& NodeContest::other_surface(std::size_t k) const {
  return *(*scans_)[scan_->other[k]].surface;
}

const PairStart& NodeContest::start(std::size_t k, std::size_t sample) {
  if (!is_laid_out_) {
    lay_out();
  }
  const Lattice& lattice = scan_->surface->lattice;
  const bool below = lattice.sample_row(sample) >= row_ + Lattice::kNodeSide;
  const bool beside = lattice.sample_col(sample) >= col_ + Lattice::kNodeSide;
  const std::size_t at = k * kStarts + (below ? 2U : 0U) + (beside ? 1U : 0U);
  if (start_known_[at] == 0) {
    starts_[at] = pair_start(*scan_->surface, lattice.node_of(sample), other_surface(k), *scan_->pairs[k]);
    start_known_[at] = 1;
  }
  return starts_[at];
}

std::int64_t NodeContest::pair(std::size_t k, std::size_t sample) {
  if (!is_laid_out_) {
    lay_out();
  }
  const Lattice& lattice = scan_->surface->lattice;
  const int at = (lattice.sample_row(sample) - row_) * kAskedSide + lattice.sample_col(sample) - col_;
  std::int32_t& known = pair_[k * kAsked + static_cast<std::size_t>(at)];
  if (known == kNotAsked) {
    const PairStart& from = start(k, sample);
    known = from.sample < 0 ? -1
                            : static_cast<std::int32_t>(
                                  pair_of(*scan_->surface, sample, from, other_surface(k), *scan_->pairs[k]));
  }
  return known;
}

bool NodeContest::is_taken_by(std::size_t k, std::size_t i) {
  const OwnedScan& other = (*scans_)[scan_->other[k]];
  const PairStart& from = start(k, i);
  if (from.sample < 0) {
    return false;
  }
  const std::int64_t likely =
      likely_sample(from, *other.surface, scan_->pairs[k]->on_other(scan_->surface->points[i]));
  if (likely >= 0 && other.near_kept[static_cast<std::size_t>(likely)] == kAllAroundKept &&
      may_pair(*scan_->surface, i, *other.surface, static_cast<std::size_t>(likely), *scan_->pairs[k])) {
    return true;
  }
  const std::int64_t j = pair(k, i);
  if (j < 0 || other.near_kept[static_cast<std::size_t>(j)] == 0) {
    return false;
  }
  if (other.near_kept[static_cast<std::size_t>(j)] == kAllAroundKept) {
    return true;
  }
  const Window window(other, j);
  const auto clearance = static_cast<float>(options_->clearance_factor *
                                            std::max(scan_->surface->spacing_mm, other.surface->spacing_mm));
  const Vector3f p = scan_->fused->slot[i] == FusedSamples::kNone
                         ? scan_->surface->moved_back(scan_->surface->points[i])
                         : scan_->fused->point(i);
  bool taken = false;
  const Vector3f n = other.surface->normal(static_cast<std::size_t>(j));
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
  if (taken) {
    return true;
  }
  const FlatWindow flat(window, Plane(p, n));
  return window.any_triangle([&](const std::array<std::size_t, 3>& t) {
    return inside(Vector2f::Zero(), flat.at[t[0]], flat.at[t[1]], flat.at[t[2]]);
  });
}

bool NodeContest::is_taken(std::size_t i) {
  // First those that are likeliest to say yes.
  if (last_taker_ < scan_->pairs.size() && contest_->by_pair[last_taker_][node_] != 0 &&
      is_taken_by(last_taker_, i)) {
    return true;
  }
  for (const std::uint8_t nearness : {2, 1}) {
    for (std::size_t k = 0; k < scan_->pairs.size(); ++k) {
      if (contest_->by_pair[k][node_] == nearness && k != last_taker_ && is_taken_by(k, i)) {
        last_taker_ = k;
        return true;
      }
    }
  }
  return false;
}

bool NodeContest::is_near(std::size_t k, const std::array<std::size_t, 3>& t) {
  const std::vector<std::uint8_t>& near_kept = (*scans_)[scan_->other[k]].near_kept;
  return std::ranges::any_of(t, [&](std::size_t corner) {
    const std::int64_t j = pair(k, corner);
    return j >= 0 && near_kept[static_cast<std::size_t>(j)] != 0;
  });
}

bool NodeContest::meets_another(std::span<const Vector3f> points, const std::array<std::size_t, 3>& t) {
  // Most lie near nothing: for them no plane is laid.
  std::size_t k = 0;
  while (k < scan_->pairs.size() && (contest_->by_pair[k][node_] == 0 || !is_near(k, t))) {
    ++k;
  }
  if (k == scan_->pairs.size()) {
    return false;
  }
  const Vector3f &p0 = points[t[0]], &p1 = points[t[1]], &p2 = points[t[2]];
  const Plane plane(p0, (p1 - p0).cross(p2 - p0).normalized());
  const FlatTriangle flat = {plane(p0), plane(p1), plane(p2)};
  for (; k < scan_->pairs.size(); ++k) {
    if (contest_->by_pair[k][node_] == 0) {
      continue;
    }
    const OwnedScan& other = (*scans_)[scan_->other[k]];
    // The pairs of the three corners mostly lie side by side: one window for all of them.
    std::optional<Window> window;
    for (const std::size_t corner : t) {
      const std::int64_t j = pair(k, corner);
      if (j < 0 || other.near_kept[static_cast<std::size_t>(j)] == 0) {
        continue;
      }
      const Window around(other, j);
      if (!window) {
        window = around;
      } else if (!window->take_in(around) && meets(around, flat, plane, scan_->pairs[k]->reach_mm)) {
        return true;
      }
    }
    if (window && meets(*window, flat, plane, scan_->pairs[k]->reach_mm)) {
      return true;
    }
  }
  return false;
}

}  // namespace dubsar
