// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace dubsar {

/// How far apart the rows of a continuous scan come: the stage's way from row to row, by the rate that the
/// camera keeps and not by the one that it tells. A grid's header says this one.
class RowPitch {
 public:
  /// Rows that are asked to be `step` apart, mm, or radians of a stage that turns; it goes at `speed`, mm/s
  /// or rad/s, once it has gathered it. Without a speed (0) rows are as far apart as was asked until
  /// remark().
  RowPitch(double step, double speed, bool rotary) : step_(step), speed_(speed), rotary_(rotary) {}

  /// The row that number `row` of the camera became, when it was taken, and where the stage was, known to
  /// kSureSteps. Ascending.
  void add(std::int64_t row, std::int64_t timestamp_ns, double position);
  /// Enough of them have come to tell.
  [[nodiscard]] bool is_known() const;
  /// From row to row, by the clock; `step` where that is not known to be more than a tenth off it.
  [[nodiscard]] double value() const;
  /// For the operator, by all of the stage's way; nothing where rows are as far apart as was asked.
  [[nodiscard]] std::optional<std::string> remark() const;

 private:
  struct Row {
    std::int64_t number = 0, timestamp_ns = 0;
    double position = 0;
  };
  [[nodiscard]] double unless_near(double pitch, double rows) const;

  double step_, speed_;
  bool rotary_;
  std::optional<Row> first_;
  Row last_;
};

}  // namespace dubsar
