// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>

namespace dubsar {

/// Which row of a continuous scan a frame is: the frames' own numbers count the rows, and where the stage was
/// says which frames belong to the scan.
class RowCount {
 public:
  /// A scan of `rows` from `start` on, `step` > 0 apart; mm or radians.
  RowCount(double start, double step, int rows);

  struct Placed {
    std::int64_t row = 0;
    std::uint64_t missed = 0;  ///< rows before it, since the last, that no frame came of
  };
  /// Of the frame `id`, taken at `position`; nothing when it was taken outside of the scan. Numbers ascend.
  [[nodiscard]] std::optional<Placed> place(std::int64_t id, double position);
  /// Rows of the scan that passed between the last frame that was placed and `position`, where the stage was
  /// at a later one or came to rest, and that no frame came of. `pitch` is how far apart they came, where
  /// that is not the step.
  [[nodiscard]] std::uint64_t missed_until(double position, std::optional<double> pitch = {}) const;
  /// Whether a frame was placed.
  [[nodiscard]] bool any() const { return first_.has_value(); }
  /// Whether the scan ends within `steps` of `position`: half a step is its last row.
  [[nodiscard]] bool ends_within(double steps, double position) const;
  [[nodiscard]] double end() const { return end_; }

 private:
  double start_, step_, end_;
  std::optional<std::int64_t> first_;  ///< number of the frame of row 0, whether it came or not
  std::int64_t next_ = 0;
  double last_ = 0;  ///< where the stage was at the last frame that was placed
};

}  // namespace dubsar
