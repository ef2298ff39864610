// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"
#include "core/sample_flags.h"

namespace dubsar {

/// A link between X or Y neighbours longer than this many µ is a gap: a slope of acos(1/3) = 70.5° (seed 001,
/// 3.3).
inline constexpr double kGapInSpacings = 3.0;

/// Which samples of one scan are potentially sparse and sparse (seed 001, 3.3, steps 1 and 2).
/// Potentially sparse: one of the four X and Y neighbours is missing or farther than 3µ. Sparse: at least
/// five of the eight surrounding cells are potentially sparse, where empty cells and cells outside the grid
/// count as such. Samples that are not finite count as missing. µ is grid.spacing_mm, or
/// estimate_spacing_mm() where that is not known. Uses both cores; the result depends on the grid alone.
[[nodiscard]] SampleFlags flag_sparse(const RangeGrid& grid);

/// The same for a grid in which samples are already known to be no tablet: flags carries kNotTablet in, such
/// samples count as missing, and kCleared and kExcused are dropped. A `flags` of another length starts empty.
void reflag_sparse(const RangeGrid& grid, SampleFlags& flags);

/// A rolling window over three profiles from which both the batch and the streaming flags are computed, so
/// that the two cannot differ. Rows go in from the first to the last.
class SparseWindow {
 public:
  SparseWindow(int cols, double spacing_mm);

  /// One profile: `cols` coordinates and validities; `flags` may be null (no sample is kNotTablet).
  struct Row {
    const float* x = nullptr;
    const float* y = nullptr;
    const float* z = nullptr;
    const std::uint8_t* valid = nullptr;
    const std::uint8_t* flags = nullptr;
  };

  /// The next profile has come. Afterwards the row before it has final potential flags and the row before
  /// that one final flags.
  void push(const Row& row);
  /// The grid ends, or has not begun: a row of cells outside the grid.
  void push_outside();

  /// Final flags of the row pushed `back` = 2 pushes before the last one; keeps kNotTablet of what `flags`
  /// held.
  void write_final(std::uint8_t* flags) const;
  /// Best knowledge of the last row (back = 0) or the one before it (back = 1): what has not come yet counts
  /// as well sampled, so that the newest profiles do not flash red.
  void write_provisional(int back, std::uint8_t* flags) const;

 private:
  struct Line {
    std::vector<float> x, y, z;
    std::vector<std::uint8_t> usable;  ///< [cols] a finite sample of the tablet
    std::vector<std::uint8_t> linked;  ///< [cols] its neighbours on the left, on the right and above are near
    std::vector<std::uint8_t> down;    ///< [cols] the neighbour below is near
    std::vector<std::uint8_t> sparse;  ///< [cols + 2] potentially sparse, empty or outside; padded
  };
  [[nodiscard]] Line& line(int back) { return lines_[static_cast<std::size_t>((head_ + 4 - back) % 4)]; }
  [[nodiscard]] const Line& line(int back) const {
    return lines_[static_cast<std::size_t>((head_ + 4 - back) % 4)];
  }
  void advance();
  void settle_previous();
  void write(const Line& here, const std::uint8_t* above, const std::uint8_t* at, const std::uint8_t* below,
             std::uint8_t* flags) const;

  std::size_t cols_;
  float limit2_mm2_;
  int head_ = 0;
  std::array<Line, 4> lines_;
  std::vector<std::uint8_t> right_;    ///< [cols + 1] link from col-1 to col
  std::vector<std::uint8_t> nothing_;  ///< [cols + 2] zeros: a row that has not come yet
};

/// Flags of a scan that streams in: after each appended profile the flags of the last three rows are brought
/// up to date. Row r is final once row r+2 or the end is there, and then equals flag_sparse() of the whole
/// grid.
class SparseFlagger {
 public:
  /// spacing_mm: nominal µ of the scan, > 0; it has to be known before the first profile.
  SparseFlagger(int cols, double spacing_mm);

  /// Rows whose flags an update touched, [first, last).
  struct Touched {
    int first = 0;
    int last = 0;
  };

  /// Profiles were appended to the grid (grid.size() / cols rows are there; grid.cols must be the cols of
  /// this flagger). Sizes `flags` to the grid and updates it. kNotTablet bits that are set in the appended
  /// rows count.
  Touched update(const RangeGrid& grid, SampleFlags& flags);
  /// No more profiles come: the last two rows become final.
  Touched finish(const RangeGrid& grid, SampleFlags& flags);

 private:
  std::size_t cols_;
  int rows_ = 0;
  bool finished_ = false;
  SparseWindow window_;
};

}  // namespace dubsar
