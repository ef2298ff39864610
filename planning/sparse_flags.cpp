// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Under-sampling detection, seed 001, 3.3. One pass over contiguous rows; every inner loop is free of
// branches and works on arrays that do not alias, so that the compiler turns it into vector code.
#include "planning/sparse_flags.h"

#include <algorithm>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::uint8_t kMoreThanHalfOfEight = 5;
/// Rows per task: the four halo rows that a task computes twice stay below a tenth.
constexpr std::size_t kRowsPerTask = 48;

std::uint8_t as_byte(bool b) {
  return static_cast<std::uint8_t>(b);
}

/// Link from each sample of row a to the sample below it in row b.
void link_rows(std::size_t n, float limit2, const float* __restrict ax, const float* __restrict ay,
               const float* __restrict az, const float* __restrict bx, const float* __restrict by,
               const float* __restrict bz, std::uint8_t* __restrict out) {
  for (std::size_t c = 0; c < n; ++c) {
    const float dx = ax[c] - bx[c];
    const float dy = ay[c] - by[c];
    const float dz = az[c] - bz[c];
    // false for NaN and for overflow
    out[c] = as_byte(dx * dx + dy * dy + dz * dz <= limit2);
  }
}

void and_rows(std::size_t n, const std::uint8_t* __restrict a, const std::uint8_t* __restrict b,
              std::uint8_t* __restrict out) {
  for (std::size_t c = 0; c < n; ++c) {
    out[c] = static_cast<std::uint8_t>(out[c] & a[c] & b[c]);
  }
}

void find_usable(std::size_t n, const SparseWindow::Row& row, std::uint8_t* __restrict usable) {
  for (std::size_t c = 0; c < n; ++c) {
    // A finite number times zero is zero; NaN and infinity are not.
    const float zero = row.x[c] * 0.0F + row.y[c] * 0.0F + row.z[c] * 0.0F;
    usable[c] = as_byte(zero == 0.0F);
  }
  for (std::size_t c = 0; c < n; ++c) {
    usable[c] = static_cast<std::uint8_t>(usable[c] & as_byte(row.valid[c] != 0));
  }
  if (row.flags != nullptr) {
    for (std::size_t c = 0; c < n; ++c) {
      usable[c] = static_cast<std::uint8_t>(usable[c] & as_byte((row.flags[c] & kNotTablet) == 0));
    }
  }
}

SparseWindow::Row row_of(const RangeGrid& grid, int row, const SampleFlags* flags) {
  const std::size_t i = grid.index(row, 0);
  return {grid.x.data() + i, grid.y.data() + i, grid.z.data() + i, grid.valid.data() + i,
          flags == nullptr ? nullptr : flags->data() + i};
}

}  // namespace

SparseWindow::SparseWindow(int cols, double spacing_mm)
    : cols_(static_cast<std::size_t>(std::max(cols, 0))),
      limit2_mm2_(static_cast<float>(kGapInSpacings * kGapInSpacings * spacing_mm * spacing_mm)),
      right_(cols_ + 1, 0),
      nothing_(cols_ + 2, 0) {
  for (Line& l : lines_) {
    l.x.assign(cols_, 0.0F);
    l.y.assign(cols_, 0.0F);
    l.z.assign(cols_, 0.0F);
    l.usable.assign(cols_, 0);
    l.linked.assign(cols_, 0);
    l.down.assign(cols_, 0);
    l.sparse.assign(cols_ + 2, 1);
  }
}

void SparseWindow::advance() {
  head_ = (head_ + 1) % 4;
}

void SparseWindow::settle_previous() {
  Line& l = line(1);
  const std::uint8_t* __restrict linked = l.linked.data();
  const std::uint8_t* __restrict down = l.down.data();
  std::uint8_t* __restrict sparse = l.sparse.data() + 1;
  for (std::size_t c = 0; c < cols_; ++c) {
    sparse[c] = static_cast<std::uint8_t>((linked[c] & down[c]) ^ 1U);
  }
}

void SparseWindow::push(const Row& row) {
  advance();
  Line& here = line(0);
  Line& above = line(1);
  std::copy_n(row.x, cols_, here.x.data());
  std::copy_n(row.y, cols_, here.y.data());
  std::copy_n(row.z, cols_, here.z.data());
  find_usable(cols_, row, here.usable.data());

  link_rows(cols_, limit2_mm2_, above.x.data(), above.y.data(), above.z.data(), here.x.data(), here.y.data(),
            here.z.data(), above.down.data());
  and_rows(cols_, above.usable.data(), here.usable.data(), above.down.data());
  settle_previous();

  right_.front() = 0;
  right_.back() = 0;
  if (cols_ > 1) {
    link_rows(cols_ - 1, limit2_mm2_, here.x.data(), here.y.data(), here.z.data(), here.x.data() + 1,
              here.y.data() + 1, here.z.data() + 1, right_.data() + 1);
    and_rows(cols_ - 1, here.usable.data(), here.usable.data() + 1, right_.data() + 1);
  }
  const std::uint8_t* __restrict right = right_.data();
  const std::uint8_t* __restrict up = above.down.data();
  std::uint8_t* __restrict linked = here.linked.data();
  std::uint8_t* __restrict sparse = here.sparse.data() + 1;
  for (std::size_t c = 0; c < cols_; ++c) {
    linked[c] = static_cast<std::uint8_t>(right[c] & right[c + 1] & up[c]);
    sparse[c] = static_cast<std::uint8_t>(linked[c] ^ 1U);
  }
}

void SparseWindow::push_outside() {
  advance();
  Line& here = line(0);
  std::fill(line(1).down.begin(), line(1).down.end(), std::uint8_t{0});
  settle_previous();
  std::fill(here.usable.begin(), here.usable.end(), std::uint8_t{0});
  std::fill(here.linked.begin(), here.linked.end(), std::uint8_t{0});
  std::fill(here.sparse.begin(), here.sparse.end(), std::uint8_t{1});
}

void SparseWindow::write(const Line& here, const std::uint8_t* above, const std::uint8_t* at,
                         const std::uint8_t* below, std::uint8_t* flags) const {
  const std::uint8_t* __restrict a = above;
  const std::uint8_t* __restrict h = at;
  const std::uint8_t* __restrict b = below;
  const std::uint8_t* __restrict usable = here.usable.data();
  std::uint8_t* __restrict out = flags;
  for (std::size_t c = 0; c < cols_; ++c) {
    const auto around =
        static_cast<std::uint8_t>(a[c] + a[c + 1] + a[c + 2] + h[c] + h[c + 2] + b[c] + b[c + 1] + b[c + 2]);
    const auto marks = static_cast<std::uint8_t>(h[c + 1] * kPotentiallySparse +
                                                 as_byte(around >= kMoreThanHalfOfEight) * kSparse);
    out[c] = static_cast<std::uint8_t>((out[c] & kNotTablet) | (marks * usable[c]));
  }
}

void SparseWindow::write_final(std::uint8_t* flags) const {
  write(line(2), line(3).sparse.data(), line(2).sparse.data(), line(1).sparse.data(), flags);
}

void SparseWindow::write_provisional(int back, std::uint8_t* flags) const {
  const std::uint8_t* below = back == 0 ? nothing_.data() : line(back - 1).sparse.data();
  write(line(back), line(back + 1).sparse.data(), line(back).sparse.data(), below, flags);
}

namespace {

void flag_rows(const RangeGrid& grid, double spacing_mm, const SampleFlags* not_tablet, SampleFlags& flags,
               int first, int last) {
  SparseWindow window(grid.cols, spacing_mm);
  const auto push = [&](int row) {
    if (row < 0 || row >= grid.rows) {
      window.push_outside();
    } else {
      window.push(row_of(grid, row, not_tablet));
    }
  };
  for (int row = first - 2; row < last + 2; ++row) {
    push(row);
    if (row - 2 >= first) {
      window.write_final(flags.data() + grid.index(row - 2, 0));
    }
  }
}

}  // namespace

void reflag_sparse(const RangeGrid& grid, SampleFlags& flags) {
  const bool known = flags.size() == grid.size();
  if (!known) {
    flags.assign(grid.size(), 0);
  }
  if (grid.rows <= 0 || grid.cols <= 0) {
    return;
  }
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  // A task reads kNotTablet in rows that its neighbour writes: the bit itself never changes, but the byte
  // does.
  SampleFlags not_tablet;
  if (known &&
      std::any_of(flags.begin(), flags.end(), [](std::uint8_t f) { return (f & kNotTablet) != 0; })) {
    not_tablet = flags;
  }
  parallel_chunks(static_cast<std::size_t>(grid.rows), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    flag_rows(grid, spacing_mm, not_tablet.empty() ? nullptr : &not_tablet, flags, static_cast<int>(begin),
              static_cast<int>(end));
  });
}

SampleFlags flag_sparse(const RangeGrid& grid) {
  SampleFlags flags;
  reflag_sparse(grid, flags);
  return flags;
}

SparseFlagger::SparseFlagger(int cols, double spacing_mm)
    : cols_(static_cast<std::size_t>(std::max(cols, 0))), window_(cols, spacing_mm) {
  window_.push_outside();
  window_.push_outside();
}

SparseFlagger::Touched SparseFlagger::update(const RangeGrid& grid, SampleFlags& flags) {
  flags.resize(grid.size(), 0);
  if (cols_ == 0 || finished_) {
    return {rows_, rows_};
  }
  const int there = static_cast<int>(grid.size() / cols_);
  if (there <= rows_) {
    return {rows_, rows_};
  }
  const int first = std::max(rows_ - 2, 0);
  for (; rows_ < there; ++rows_) {
    const std::size_t i = static_cast<std::size_t>(rows_) * cols_;
    window_.push(
        {grid.x.data() + i, grid.y.data() + i, grid.z.data() + i, grid.valid.data() + i, flags.data() + i});
    if (rows_ >= 2) {
      window_.write_final(flags.data() + i - 2 * cols_);
    }
  }
  const std::size_t newest = static_cast<std::size_t>(rows_ - 1) * cols_;
  if (rows_ >= 2) {
    window_.write_provisional(1, flags.data() + newest - cols_);
  }
  window_.write_provisional(0, flags.data() + newest);
  return {first, rows_};
}

SparseFlagger::Touched SparseFlagger::finish(const RangeGrid& grid, SampleFlags& flags) {
  const Touched last = update(grid, flags);
  if (cols_ == 0 || finished_) {
    return last;
  }
  finished_ = true;
  const int first = std::max(std::min(last.first, rows_ - 2), 0);
  for (int row = rows_; row < rows_ + 2; ++row) {
    window_.push_outside();
    if (row - 2 >= 0 && row - 2 < rows_) {
      window_.write_final(flags.data() + static_cast<std::size_t>(row - 2) * cols_);
    }
  }
  return {first, rows_};
}

}  // namespace dubsar
