// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/row_count.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

RowCount::RowCount(double start, double step, int rows)
    : start_(start), step_(step), end_(start + step * (rows - 1)) {}

std::optional<RowCount::Placed> RowCount::place(std::int64_t id, double position) {
  if (!(position >= start_ - 0.5 * step_ && position < end_ + 0.5 * step_)) {
    return std::nullopt;
  }
  if (!first_) {
    // Where the stage was when the frames before this one were taken nobody knew: rows that are lost.
    first_ = id - static_cast<std::int64_t>(std::max(0.0, std::floor((position - start_) / step_ + 0.5)));
  }
  const std::int64_t row = id - *first_;
  const std::int64_t missed = std::max<std::int64_t>(0, row - next_);
  next_ = row + 1;
  last_ = position;
  return Placed{row, static_cast<std::uint64_t>(missed)};
}

std::uint64_t RowCount::missed_until(double position, std::optional<double> pitch) const {
  if (!first_) {
    return 0;
  }
  const double apart = pitch.value_or(step_);
  const double steps = std::floor((std::min(position, end_ + apart) - last_) / apart + 0.5) - 1;
  return static_cast<std::uint64_t>(std::max(0.0, steps));
}

bool RowCount::ends_within(double steps, double position) const {
  return position > end_ - steps * step_;
}

}  // namespace dubsar
