// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/row_pitch.h"

#include <algorithm>
#include <cmath>

#include "acquisition/rig_parts.h"

namespace dubsar {

namespace {

constexpr std::int64_t kEnoughRows = 16;
constexpr double kMostOff = 0.1;  // of a step
/// Three standard deviations of both ends' places together, in steps: what may be said of few rows.
const double kUnsureSteps = 3 * std::sqrt(2.0) * kSureSteps;

}  // namespace

void RowPitch::add(std::int64_t row, std::int64_t timestamp_ns, double position) {
  last_ = {row, timestamp_ns, position};
  first_ = first_ ? first_ : std::optional(last_);
}

bool RowPitch::is_known() const {
  return first_ && last_.number - first_->number >= kEnoughRows;
}

double RowPitch::unless_near(double pitch, double rows) const {
  return pitch > 0 && std::abs(pitch / step_ - 1) > std::max(kMostOff, kUnsureSteps / rows) ? pitch : step_;
}

double RowPitch::value() const {
  if (!first_ || last_.number <= first_->number || speed_ <= 0) {
    return step_;
  }
  const auto rows = static_cast<double>(last_.number - first_->number);
  return unless_near(1e-9 * static_cast<double>(last_.timestamp_ns - first_->timestamp_ns) * speed_ / rows,
                     rows);
}

std::optional<std::string> RowPitch::remark() const {
  if (!first_ || last_.number <= first_->number) {
    return std::nullopt;
  }
  const auto rows = static_cast<double>(last_.number - first_->number);
  const double pitch = unless_near((last_.position - first_->position) / rows, rows);
  if (pitch == step_) {
    return std::nullopt;
  }
  const std::string apart =
      position_text(rotary_, pitch) + " apart, and the step is " + position_text(rotary_, step_);
  return pitch > step_ ? "the camera is too slow for the stage: rows came " + apart +
                             "; shorten its exposure, or let the stage go more slowly"
                       : "the camera is too fast for the stage: rows came " + apart +
                             "; lower its rate, or let the stage go faster";
}

}  // namespace dubsar
