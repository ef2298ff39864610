// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/scan_marks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"
#include "core/wide_clones.h"
#include "core/wide_vec.h"

namespace dubsar {

namespace {

/// A mark stands out of all samples that are no farther than so many rows and columns.
constexpr int kReach = 4;
/// Rows of which the marks are looked for at once.
constexpr std::size_t kBandRows = 64;
/// Some ten thousand settle a median.
constexpr std::size_t kSome = 60000;
constexpr float kMissing = -1.0F;
constexpr float kLongestLink = 3.0F;  ///< spacings; longer is an edge in depth (seed 001, 3.3)

/// Text with three decimals of a millimetre, written of both copies, is off by 0.0004 mm. Noise of so little
/// no scanner has.
constexpr double kLeastRoundingMm = 0.0005;
/// Two scans from one place differ by 1.4 times the noise.
constexpr double kRoundingOfNoise = 0.15;
constexpr double kRoundingOfSpacing = 0.05;
/// A mark stands out by so many times the rounding: 1.5 times the noise.
constexpr double kLeastOfRounding = 10.0;

/// Divisors of second differences over four neighbours, of their differences, and of twists.
const float kOfBend = std::sqrt(20.0F);
constexpr float kOfSaddle = 2.0F;
const float kOfTwist = std::sqrt(12.0F);

std::size_t step_through(const RangeGrid& grid) {
  return std::max<std::size_t>(1, grid.size() / kSome);
}

double spacing_of(const RangeGrid& grid) {
  std::vector<float> along;
  std::vector<float> across;
  const auto take = [&grid](std::size_t i, std::size_t j, std::vector<float>& steps) {
    if (const float step_mm = (grid.point(j) - grid.point(i)).norm(); std::isfinite(step_mm)) {
      steps.push_back(step_mm);
    }
  };
  for (std::size_t i = 0; i < grid.size(); i += step_through(grid)) {
    if (grid.valid[i] == 0) {
      continue;
    }
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    if (grid.is_valid(row, col + 1)) {
      take(i, i + 1, along);
    }
    if (grid.is_valid(row + 1, col)) {
      take(i, grid.index(row + 1, col), across);
    }
  }
  return along.empty() || across.empty()
             ? 0.0
             : static_cast<double>(std::max(median_of(std::move(along)), median_of(std::move(across))));
}

using wide::larger;
using wide::Vec;

/// How far a sample stands out of the four beside it, mm; kMissing where one of the five is not there or far
/// off, or is no number. Without a branch, so that the compiler can work on several samples at once.
[[gnu::always_inline]] inline float stands_out_of(const Vec& at, const Vec& before, const Vec& after,
                                                  const Vec& above, const Vec& below,
                                                  std::int32_t all_are_there, float longest2_mm2) {
  const Vec left = step(at, before), right = step(at, after);
  const Vec up = step(at, above), down = step(at, below);
  const float longest2 =
      larger(larger(larger(dot(left, left), dot(right, right)), dot(up, up)), dot(down, down));
  const Vec normal = cross(step(left, right), step(up, down));
  const float length = std::sqrt(dot(normal, normal));
  const Vec sum = {left.x + right.x + up.x + down.x, left.y + right.y + up.y + down.y,
                   left.z + right.z + up.z + down.z};
  const float out_mm = std::abs(dot(sum, normal)) / (kOfBend * length);
  const std::int32_t has = static_cast<std::int32_t>(all_are_there != 0) &
                           static_cast<std::int32_t>(longest2 <= longest2_mm2) &
                           static_cast<std::int32_t>(length > 0);
  return has != 0 ? out_mm : kMissing;
}

/// Samples of a row that are worked on at a time: what they need lies in the first cache.
constexpr int kBlock = 64;

/// Part of a row with one sample more at either end, each quantity by itself.
struct RowPart {
  float x[kBlock + 2] = {}, y[kBlock + 2] = {}, z[kBlock + 2] = {};
  std::int32_t valid[kBlock + 2] = {};

  /// `count` samples from the grid's sample `first` on.
  [[gnu::always_inline]] void fill(const RangeGrid& grid, std::size_t first, int count) {
    for (int c = 0; c < count; ++c) {
      const std::size_t i = first + static_cast<std::size_t>(c);
      x[c] = grid.x[i];
      y[c] = grid.y[i];
      z[c] = grid.z[i];
      valid[c] = grid.valid[i];
    }
  }
  [[gnu::always_inline]] [[nodiscard]] Vec at(int c) const { return {x[c], y[c], z[c]}; }
};

/// stands_out_of() of a row that is not the first or last, all but its ends; out_mm: [cols].
DUBSAR_WIDE_CLONES void row_stands_out(const RangeGrid& grid, int row, float longest2_mm2, float* out_mm) {
  const auto wide = static_cast<std::size_t>(grid.cols);
  RowPart above, here, below;
  float out[kBlock] = {};
  for (int begin = 1; begin + 1 < grid.cols; begin += kBlock) {
    const int count = std::min(grid.cols - 1 - begin, kBlock);
    const std::size_t first = grid.index(row, begin - 1);
    above.fill(grid, first - wide, count + 2);
    here.fill(grid, first, count + 2);
    below.fill(grid, first + wide, count + 2);
    for (int c = 0; c < count; ++c) {
      const int i = c + 1;
      const std::int32_t all =
          here.valid[i] & here.valid[i - 1] & here.valid[i + 1] & above.valid[i] & below.valid[i];
      out[c] = stands_out_of(here.at(i), here.at(i - 1), here.at(i + 1), above.at(i), below.at(i), all,
                             longest2_mm2);
    }
    std::copy_n(out, count, out_mm + begin);
  }
}

/// What surrounds samples that are not in the first or last row or column.
class Surroundings {
 public:
  Surroundings(const RangeGrid& grid, double spacing_mm)
      : grid_(grid),
        wide_(static_cast<std::size_t>(grid.cols)),
        longest2_(static_cast<float>(kLongestLink * kLongestLink * spacing_mm * spacing_mm)) {}

  /// How far a sample stands out of the four beside it, mm, or kMissing.
  [[nodiscard]] float stands_out(std::size_t i) const {
    const std::int32_t all = grid_.valid[i] & grid_.valid[i - 1] & grid_.valid[i + 1] &
                             grid_.valid[i - wide_] & grid_.valid[i + wide_];
    return stands_out_of(at(i), at(i - 1), at(i + 1), at(i - wide_), at(i + wide_), all, longest2_);
  }
  /// The same of all of a row but its ends, many at a time: several times as fast. out_mm: [cols].
  void stand_out(int row, float* out_mm) const { row_stands_out(grid_, row, longest2_, out_mm); }

  /// Of a sample that stands out; nothing where one of the eight around it is missing or far off.
  [[nodiscard]] std::optional<ScanMark> mark(std::size_t i) const {
    const std::array<std::size_t, 8> beside{i - 1,         i + 1,         i - wide_,     i + wide_,
                                            i - wide_ - 1, i + wide_ + 1, i - wide_ + 1, i + wide_ - 1};
    const auto is_near = [&](std::size_t j) {  // NaN is not
      return grid_.valid[j] != 0 && (grid_.point(j) - grid_.point(i)).squaredNorm() <= 4 * longest2_;
    };
    if (!std::ranges::all_of(beside, is_near)) {
      return std::nullopt;
    }
    std::array<Eigen::Vector3f, 8> to;
    std::ranges::transform(beside, to.begin(),
                           [&](std::size_t j) -> Eigen::Vector3f { return grid_.point(j) - grid_.point(i); });
    const auto& [left, right, up, down, up_left, down_right, up_right, down_left] = to;
    const Eigen::Vector3f along = left + right;
    const Eigen::Vector3f across = up + down;
    const Eigen::Vector3f falling = up_left + down_right;
    const Eigen::Vector3f rising = up_right + down_left;
    Eigen::Vector3f normal = upright(i).normalized();
    normal = (along + across).dot(normal) < 0 ? Eigen::Vector3f(-normal) : normal;
    const Eigen::Vector3f twist_along = 2.0F * (right - left) - (down_right + up_right - up_left - down_left);
    const Eigen::Vector3f twist_across = 2.0F * (down - up) - (down_right + down_left - up_left - up_right);
    const auto [less, more] = std::minmax({twist_along.norm(), twist_across.norm()});
    return ScanMark{grid_.point(i),
                    {(along + across).dot(normal) / kOfBend, (falling + rising).dot(normal) / kOfBend,
                     (along - across).norm() / kOfSaddle, (falling - rising).norm() / kOfSaddle,
                     more / kOfTwist, less / kOfTwist},
                    false};
  }

 private:
  [[nodiscard]] Vec at(std::size_t i) const { return {grid_.x[i], grid_.y[i], grid_.z[i]}; }
  /// Along the normal of the surface.
  [[nodiscard]] Eigen::Vector3f upright(std::size_t i) const {
    return (grid_.point(i + 1) - grid_.point(i - 1)).cross(grid_.point(i + wide_) - grid_.point(i - wide_));
  }

  const RangeGrid& grid_;
  std::size_t wide_;
  float longest2_;
};

[[nodiscard]] bool is_inner(const RangeGrid& grid, int row, int col) {
  return row > 0 && col > 0 && row + 1 < grid.rows && col + 1 < grid.cols;
}

/// Of one coordinate, by the quarter of the samples that stand out least: relief does not show there.
double noise_mm(const RangeGrid& grid, const Surroundings& around) {
  constexpr double kQuarterOfNormal = 0.3186;  ///< Φ⁻¹(5/8)
  std::vector<float> some;
  for (std::size_t i = 0; i < grid.size(); i += step_through(grid)) {
    if (is_inner(grid, grid.row_of(i), grid.col_of(i))) {
      if (const float out_mm = around.stands_out(i); out_mm >= 0) {
        some.push_back(out_mm);
      }
    }
  }
  return some.empty() ? 0.0 : static_cast<double>(value_at_rank(some, some.size() / 4)) / kQuarterOfNormal;
}

/// How far the samples of some rows stand out.
class Band {
 public:
  Band(const RangeGrid& grid, const Surroundings& around, int first_row, int end_row)
      : first_(std::max(0, first_row)), end_(std::min(grid.rows, end_row)), cols_(grid.cols) {
    out_mm_.assign(static_cast<std::size_t>(end_ - first_) * static_cast<std::size_t>(cols_), kMissing);
    for (int row = std::max(first_, 1); row < std::min(end_, grid.rows - 1); ++row) {
      around.stand_out(row, line_of(row));
    }
  }

  [[nodiscard]] float at(int row, int col) const { return line_of(row)[col]; }
  /// Of all around it; `some_are_missing` means nothing where it is not.
  [[nodiscard]] bool is_highest(int row, int col, bool& some_are_missing) const {
    const float own = at(row, col);
    some_are_missing =
        row - kReach < first_ || row + kReach >= end_ || col - kReach < 0 || col + kReach >= cols_;
    for (int r = std::max(first_, row - kReach); r < std::min(end_, row + kReach + 1); ++r) {
      const float* const line = line_of(r);
      for (int c = std::max(0, col - kReach); c < std::min(cols_, col + kReach + 1); ++c) {
        if (line[c] >= own && (r != row || c != col)) {
          return false;
        }
        some_are_missing = some_are_missing || line[c] < 0;
      }
    }
    return true;
  }

 private:
  [[nodiscard]] const float* line_of(int row) const {
    return out_mm_.data() + static_cast<std::size_t>(row - first_) * static_cast<std::size_t>(cols_);
  }
  [[nodiscard]] float* line_of(int row) {
    return out_mm_.data() + static_cast<std::size_t>(row - first_) * static_cast<std::size_t>(cols_);
  }

  int first_, end_, cols_;
  std::vector<float> out_mm_;
};

}  // namespace

ScanMarks scan_marks(const RangeGrid& grid) {
  ScanMarks out;
  out.spacing_mm = spacing_of(grid);
  if (out.spacing_mm <= 0) {
    return out;
  }
  const Surroundings around(grid, out.spacing_mm);
  out.rounding_mm = std::max(kLeastRoundingMm, std::min(kRoundingOfNoise * noise_mm(grid, around),
                                                        kRoundingOfSpacing * out.spacing_mm));
  out.least_mm = kLeastOfRounding * out.rounding_mm;
  const auto least_mm = static_cast<float>(out.least_mm);
  out.marks = parallel_reduce_ordered(
      static_cast<std::size_t>(grid.rows), kBandRows, std::vector<ScanMark>(),
      [&](std::size_t begin, std::size_t end) {
        const int first = static_cast<int>(begin);
        const int last = static_cast<int>(end);
        const Band band(grid, around, first - kReach, last + kReach);
        std::vector<ScanMark> found;
        for (int row = first; row < last; ++row) {
          for (int col = 0; col < grid.cols; ++col) {
            bool some_are_missing = false;
            if (band.at(row, col) >= least_mm && band.is_highest(row, col, some_are_missing)) {
              if (const auto mark = around.mark(grid.index(row, col))) {
                found.push_back(*mark);
                found.back().is_inside = !some_are_missing;
              }
            }
          }
        }
        return found;
      },
      [](std::vector<ScanMark>& all, const std::vector<ScanMark>& part) {
        all.insert(all.end(), part.begin(), part.end());
      });
  std::ranges::stable_sort(out.marks, {}, [](const ScanMark& mark) { return mark.shape[0]; });
  return out;
}

}  // namespace dubsar
