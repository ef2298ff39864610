// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>

namespace dubsar::aravis {

/// The count of an encoder that goes on where the camera's register goes round. Cameras count in 32 bits,
/// with a sign or without: a stage that drives back over the place where its camera was switched on goes from
/// 0 to 4294967295.
class EncoderCount {
 public:
  /// Another stream begins, or the camera began anew.
  void begin() { *this = {}; }

  /// Of the next frame. `raw`: as the camera says it; the first of a stream is taken as it stands.
  std::int64_t take(std::int64_t raw) {
    // Without a sign: any two numbers of 64 bits may come.
    const std::uint64_t said = static_cast<std::uint64_t>(raw);
    std::uint64_t step = last_raw_ ? said - *last_raw_ : said;
    if (last_raw_ && is_around(static_cast<std::int64_t>(step))) {
      step += static_cast<std::int64_t>(step) < 0 ? kRound : std::uint64_t{0} - kRound;
    }
    last_raw_ = said;
    count_ += step;
    return static_cast<std::int64_t>(count_);
  }

 private:
  static constexpr std::uint64_t kRound = std::uint64_t{1} << 32U;

  /// Nothing moves by half of a round from frame to frame; a longer step than a round is of a wider register.
  static bool is_around(std::int64_t step) {
    constexpr auto kWhole = static_cast<std::int64_t>(kRound);
    return (step > kWhole / 2 && step < kWhole) || (step < -kWhole / 2 && step > -kWhole);
  }

  std::optional<std::uint64_t> last_raw_;
  std::uint64_t count_ = 0;
};

}  // namespace dubsar::aravis
