// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/line_projection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr float kSlack = -0.01F;  ///< so that no line slips through between two triangles

struct Corner {
  float u, v;
};
[[gnu::always_inline]] inline float wedge(const Corner& a, const Corner& b) {
  return a.u * b.v - a.v * b.u;
}

/// Which of the cells around one a line passes through, as far as their corners tell: all nine at once, since
/// a line that misses a cell mostly misses those beside it, too.
class CellsAround {
 public:
  /// Corners [4*4] of the 3x3 cells as seen along the line, and the cells' codes.
  [[gnu::always_inline]] CellsAround(const float* u, const float* v, const std::int32_t* code) {
    for (int k = 0; k < kCells; ++k) {
      const auto wedge_of = [&](int a, int b) { return u[a] * v[b] - v[a] * u[b]; };
      const float top = wedge_of(k, k + 1);
      const float bottom = wedge_of(k + kSide, k + kSide + 1);
      const float left = wedge_of(k, k + kSide);
      const float right = wedge_of(k + 1, k + kSide + 1);
      const float main = wedge_of(k, k + kSide + 1);
      const float anti = wedge_of(k + kSide, k + 1);
      const bool is_anti = (code[k] & kCellAntidiagonal) != 0;
      const std::int32_t first = meets(is_anti ? anti : bottom, is_anti ? -top : -main, left);
      const std::int32_t second = meets(-right, is_anti ? -anti : -top, is_anti ? bottom : main);
      hit_[k] = ((code[k] & kCellFirst) != 0 ? first : 0) | ((code[k] & kCellSecond) != 0 ? second : 0);
    }
  }
  [[nodiscard]] bool any() const {
    return std::ranges::any_of(hit_, [](std::int32_t hit) { return hit != 0; });
  }
  /// Of the cell in that row and column of the nine.
  [[nodiscard]] bool is_hit(int row, int col) const {
    return hit_[static_cast<std::size_t>(row * kSide + col)] != 0;
  }

  static constexpr int kSide = 4;           ///< corners
  static constexpr int kCells = 3 * kSide;  ///< the last of each row is none
  static constexpr int kCorners =
      4 * kSide + 4;  ///< those after the last are looked at, and make no difference

 private:
  [[gnu::always_inline]] static std::int32_t meets(float a, float b, float c) {
    const float sum = a + b + c;
    const float slack = kSlack * sum;
    return static_cast<std::int32_t>(sum > 0) & static_cast<std::int32_t>(a >= slack) &
           static_cast<std::int32_t>(b >= slack) & static_cast<std::int32_t>(c >= slack);
  }
  std::array<std::int32_t, kCells> hit_;
};

/// One line and one scan.
class LineProjector {
 public:
  LineProjector(const StitchSurface& s, const Line& line)
      : s_(&s), line_(&line), turn_(s.mirrored ? -1.0F : 1.0F) {}  // triangles run as their grid does

  [[nodiscard]] Projection from_cell(float at_row, float at_col) {
    const int last_row = s_->lattice.rows - 2;
    const int last_col = s_->lattice.cols - 2;
    int row = static_cast<int>(std::clamp(at_row, 0.0F, static_cast<float>(last_row)));
    int col = static_cast<int>(std::clamp(at_col, 0.0F, static_cast<float>(last_col)));
    bool known = false;  // the corners of the cell
    std::array<Corner, 4> corners{};
    for (int step = 0; step < kMostSteps && is_whole(row, col); ++step) {
      corners = corners_of(row, col);
      const auto [rows, cols] = towards_line(corners);
      const int next_row = std::clamp(row + rows, 0, last_row);
      const int next_col = std::clamp(col + cols, 0, last_col);
      known = next_row == row && next_col == col;
      if (known) {
        break;
      }
      row = next_row;
      col = next_col;
    }
    if (s_->cells[first_sample(row, col)] != 0) {
      meet_cell(row, col, known ? corners : corners_of(row, col));
    }
    if (!(best_.weight > 0)) {
      meet_around(row, col);
    }
    if (best_.weight > 0) {
      take_normals();
    }
    return best_;
  }

 private:
  [[nodiscard]] std::size_t first_sample(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(s_->lattice.cols) +
           static_cast<std::size_t>(col);
  }

  [[nodiscard]] Corner seen_along(std::size_t i) const {
    const Vector3f d = s_->points[i] - line_->p;
    return {line_->u.dot(d), turn_ * line_->v.dot(d)};
  }

  /// By bits of the sample's row and column: 00, 01, 10, 11.
  [[nodiscard]] std::array<Corner, 4> corners_of(int row, int col) const {
    const std::size_t i00 = first_sample(row, col);
    const std::size_t i10 = i00 + static_cast<std::size_t>(s_->lattice.cols);
    return {seen_along(i00), seen_along(i00 + 1), seen_along(i10), seen_along(i10 + 1)};
  }
  [[nodiscard]] bool is_whole(int row, int col) const {
    const std::uint8_t* const above = &s_->usable[first_sample(row, col)];
    const std::uint8_t* const below = above + s_->lattice.cols;
    return (above[0] & above[1] & below[0] & below[1] & kUsable) != 0;
  }

  /// To which of the cells beside the one with these corners the line passes, as rows and columns: none where
  /// it passes through this one.
  [[nodiscard]] static std::pair<int, int> towards_line(const std::array<Corner, 4>& corners) {
    const auto& [c00, c01, c10, c11] = corners;
    const int left = wedge(c00, c10) < 0 ? 1 : 0;
    const int right = wedge(c11, c01) < 0 ? 1 : 0;
    const int above = wedge(c01, c00) < 0 ? 1 : 0;
    const int below = wedge(c10, c11) < 0 ? 1 : 0;
    return {below - above, right - left};
  }

  void meet_cell(int row, int col, const std::array<Corner, 4>& corners) {
    const std::size_t i00 = first_sample(row, col);
    const std::uint8_t cell = s_->cells[i00];
    const std::size_t i10 = i00 + static_cast<std::size_t>(s_->lattice.cols);
    const std::array<std::size_t, 4> i = {i00, i00 + 1, i10, i10 + 1};
    using Three = std::array<std::size_t, 3>;
    const bool anti = (cell & kCellAntidiagonal) != 0;
    if ((cell & kCellFirst) != 0) {
      meet(i, corners, anti ? Three{0, 2, 1} : Three{0, 2, 3});
    }
    if ((cell & kCellSecond) != 0) {
      meet(i, corners, anti ? Three{2, 3, 1} : Three{0, 3, 1});
    }
  }

  void meet_around(int row, int col) {
    const int last_row = s_->lattice.rows - 2;
    const int last_col = s_->lattice.cols - 2;
    const auto each_cell = [&](const auto& meet_one) {
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, last_row) && !(best_.weight > 0); ++r) {
        for (int c = std::max(col - 1, 0); c <= std::min(col + 1, last_col); ++c) {
          meet_one(r, c);
        }
      }
    };
    if (row == 0 || row == last_row || col == 0 || col == last_col) {
      each_cell([&](int r, int c) { meet_cell(r, c, corners_of(r, c)); });
      return;
    }
    float u[CellsAround::kCorners] = {};
    float v[CellsAround::kCorners] = {};
    std::int32_t code[CellsAround::kCells] = {};
    for (int r = 0; r < CellsAround::kSide; ++r) {
      const std::size_t first = first_sample(row - 1 + r, col - 1);
      for (int c = 0; c < CellsAround::kSide; ++c) {
        const Corner corner = seen_along(first + static_cast<std::size_t>(c));
        u[r * CellsAround::kSide + c] = corner.u;
        v[r * CellsAround::kSide + c] = corner.v;
      }
    }
    for (int r = 0; r < 3; ++r) {
      const std::size_t first = first_sample(row - 1 + r, col - 1);
      std::copy_n(&s_->cells[first], 3, &code[r * CellsAround::kSide]);
    }
    const CellsAround around(u, v, code);
    if (around.any()) {
      each_cell([&](int r, int c) {
        if (around.is_hit(r - row + 1, c - col + 1)) {
          meet_cell(r, c, corners_of(r, c));
        }
      });
    }
  }

  void meet(const std::array<std::size_t, 4>& samples, const std::array<Corner, 4>& corners,
            const std::array<std::size_t, 3>& which) {
    const Corner &a = corners[which[0]], &b = corners[which[1]], &c = corners[which[2]];
    const float wa = wedge(b, c);
    const float wb = wedge(c, a);
    const float wc = wedge(a, b);
    const float sum = wa + wb + wc;
    // Seen from below, or from the side: another fold, or no way to tell where.
    if (!(sum > 0)) {
      return;
    }
    const float slack = kSlack * sum;
    if (wa < slack || wb < slack || wc < slack) {
      return;
    }
    const std::array<std::size_t, 3> t = {samples[which[0]], samples[which[1]], samples[which[2]]};
    const float inverse = 1.0F / sum;
    const Vector3f &n = line_->n, &p = line_->p;
    const float along = (wa * n.dot(s_->points[t[0]] - p) + wb * n.dot(s_->points[t[1]] - p) +
                         wc * n.dot(s_->points[t[2]] - p)) *
                        inverse;
    if (best_.weight > 0 && std::abs(along) >= std::abs(best_.along_mm)) {
      return;
    }
    best_.sample = t[0];
    corners_ = t;
    shares_ = {wa * inverse, wb * inverse, wc * inverse};
    best_.along_mm = along;
    best_.well_sampled = !s_->is_sparse(t[0]) && !s_->is_sparse(t[1]) && !s_->is_sparse(t[2]);
    best_.rim = std::min({s_->rim[t[0]], s_->rim[t[1]], s_->rim[t[2]]});
    // Variances of independent samples: Σ λ² / w.
    const float la = wa * inverse, lb = wb * inverse, lc = wc * inverse;
    best_.weight =
        1.0F / (la * la / s_->weight(t[0]) + lb * lb / s_->weight(t[1]) + lc * lc / s_->weight(t[2]));
    best_.reliability = std::clamp(
        (wa * s_->reliability(t[0]) + wb * s_->reliability(t[1]) + wc * s_->reliability(t[2])) * inverse,
        0.0F, 1.0F);
  }

  /// The normal, and by all three the bulge. Along an edge whose ends look apart, a surface of even curvature
  /// rises above the chord by ½ λ (1 - λ) (n_b - n_a)·(b - a); of a triangle the three edges' parts add up.
  void take_normals() {
    std::array<Vector3f, 3> n;
    for (std::size_t k = 0; k < 3; ++k) {
      n[k] = s_->normal(corners_[k]);
    }
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = k == 2 ? 0 : k + 1;
      sum += shares_[k] * shares_[next] *
             (n[next] - n[k]).dot(s_->points[corners_[next]] - s_->points[corners_[k]]);
    }
    best_.normal = n[0];  // its first corner is best_.sample
    best_.bulge_mm = 0.5F * sum;
  }

  static constexpr int kMostSteps = 6;
  const StitchSurface* s_;
  const Line* line_;
  float turn_;
  Projection best_;
  std::array<std::size_t, 3> corners_{};  ///< of the triangle that it meets
  std::array<float, 3> shares_{};         ///< barycentric
};

}  // namespace

Projection project(const Line& line, const StitchSurface& on, float at_row, float at_col) {
  return LineProjector(on, line).from_cell(at_row, at_col);
}

}  // namespace dubsar
