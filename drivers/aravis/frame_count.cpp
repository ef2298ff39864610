// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/frame_count.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace dubsar::aravis {

namespace {

constexpr std::uint64_t kWrap = 65535;
constexpr std::size_t kPeriods = 31;  // that the rate is taken from
/// What a clock that goes on may seem to be off by: frames that waited, and a clock asked on a busy machine.
constexpr std::int64_t kSameClockNs = 500'000'000;

}  // namespace

void FrameCount::begin() {
  *this = {};
}

void FrameCount::go_on() {
  last_raw_ = 0;
}

std::uint64_t FrameCount::missed_until(std::int64_t timestamp_ns) const {
  if (periods_ns_.empty()) {
    return 0;  // nobody knows the rate
  }
  // The median: a stream that has just begun, or stood still once, does not tell its rate by its mean.
  std::vector<double> sorted(periods_ns_.begin(), periods_ns_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  const double periods = static_cast<double>(timestamp_ns - last_->timestamp_ns) / *middle;
  return static_cast<std::uint64_t>(std::max(0LL, std::llround(periods) - 1));
}

FrameCount::Step FrameCount::take(std::uint64_t raw, std::int64_t timestamp_ns, std::int64_t device_ns) {
  Step out;
  if (last_raw_ != 0) {
    const bool wrapped = raw < last_raw_ && last_raw_ <= kWrap && last_raw_ - raw > kWrap / 2;
    const std::uint64_t step = wrapped ? raw + kWrap - last_raw_ : raw > last_raw_ ? raw - last_raw_ : 1;
    out.lost = step - 1;
    if (timestamp_ns > last_->timestamp_ns) {
      periods_ns_.push_back(static_cast<double>(timestamp_ns - last_->timestamp_ns) /
                            static_cast<double>(step));
    }
    if (periods_ns_.size() > kPeriods) {
      periods_ns_.pop_front();
    }
  } else if (last_) {
    out.lost = missed_until(timestamp_ns);
    const std::int64_t theirs = device_ns - last_->device_ns;
    const std::int64_t ours = timestamp_ns - last_->timestamp_ns;
    out.camera_restarted = device_ns == 0 || std::abs(theirs - ours) > kSameClockNs;
  }
  out.id = (last_ ? last_->id : 0) + 1 + out.lost;
  last_raw_ = raw;
  last_ = Seen{out.id, timestamp_ns, device_ns};
  return out;
}

}  // namespace dubsar::aravis
