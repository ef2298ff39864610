// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/frame_count.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/order_statistics.h"

namespace dubsar::aravis {

namespace {

constexpr std::uint64_t kWrap = 65535;
constexpr std::uint64_t kLongestStep = std::uint64_t{1} << 31U;
constexpr std::size_t kOfLate = 32;  // frames that the rate is taken from
/// What a clock that goes on may seem to be off by: frames that waited, and a clock asked on a busy machine.
constexpr std::int64_t kSameClockNs = 500'000'000;

}  // namespace

void FrameCount::begin() {
  *this = {};
}

void FrameCount::go_on() {
  last_raw_ = 0;
}

/// The median of what frames a quarter of all apart tell: over one period the jitter of both frames' times
/// would count whole, over half of all a stream that stood still once would spoil every second answer.
std::optional<double> FrameCount::period_ns() const {
  if (of_late_.size() < 2) {
    return std::nullopt;
  }
  const std::size_t apart = std::max<std::size_t>(1, of_late_.size() / 4);
  std::vector<double> periods;
  for (std::size_t k = apart; k < of_late_.size(); ++k) {
    const Seen& from = of_late_[k - apart];
    periods.push_back(static_cast<double>(of_late_[k].timestamp_ns - from.timestamp_ns) /
                      static_cast<double>(of_late_[k].id - from.id));
  }
  const auto middle = median_of(std::move(periods));
  return middle > 0 ? std::optional(middle) : std::nullopt;
}

std::uint64_t FrameCount::missed_until(std::int64_t timestamp_ns) const {
  const std::optional<double> period = period_ns();
  if (!period) {
    return 0;  // nobody knows the rate
  }
  const double periods = static_cast<double>(timestamp_ns - last_->timestamp_ns) / *period;
  return static_cast<std::uint64_t>(std::max(0LL, std::llround(periods) - 1));
}

FrameCount::Step FrameCount::take(std::uint64_t raw, std::int64_t timestamp_ns, std::int64_t device_ns) {
  Step out;
  if (last_raw_ != 0) {
    const bool wrapped = raw < last_raw_ && last_raw_ <= kWrap && last_raw_ - raw > kWrap / 2;
    const std::uint64_t step = wrapped ? raw + kWrap - last_raw_ : raw - last_raw_;
    // A step back, none, or one over more frames than any stream has: its numbers say nothing.
    out.lost = step >= 1 && step <= kLongestStep ? step - 1 : 0;
  } else if (last_) {
    out.lost = missed_until(timestamp_ns);
    const std::int64_t theirs = device_ns - last_->device_ns;
    const std::int64_t ours = timestamp_ns - last_->timestamp_ns;
    out.camera_restarted = device_ns == 0 || std::abs(theirs - ours) > kSameClockNs;
    if (!period_ns()) {
      of_late_.clear();  // how many frames lie between those nobody knows
    }
  }
  out.id = (last_ ? last_->id : 0) + 1 + out.lost;
  last_raw_ = raw;
  last_ = Seen{out.id, timestamp_ns, device_ns};
  of_late_.push_back(*last_);
  if (of_late_.size() > kOfLate) {
    of_late_.pop_front();
  }
  return out;
}

}  // namespace dubsar::aravis
