// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/exposure.h"

#include <algorithm>
#include <array>

namespace dubsar {

namespace {

constexpr int kSaturatedFrom = 254;
constexpr int kBlackTo = 2;
constexpr int kLeastPeak = 12;  ///< over the background: less is no stripe (stripe.h)
constexpr int kWeakPeak = 40;
constexpr double kMostSaturated = 0.01;
constexpr double kMostWeak = 0.2;
/// A frame has a stripe when so many of its columns show one, and it is thin.
constexpr double kLeastStripeShare = 0.1;
constexpr double kMostStripePixels = 0.15;
constexpr int kDim = 64;
constexpr double kLeastBright = 0.01;
/// Pixels that are marked on either side of a weak stripe's middle.
constexpr int kMarkedHalf = 2;

/// The brightest pixel of every column, or row.
struct Lines {
  std::vector<std::uint8_t> peak;
  std::vector<int> at;
  std::vector<std::size_t> sum;
  std::size_t across = 1;  ///< pixels of one line

  Lines(int count, int length)
      : peak(static_cast<std::size_t>(count), 0),
        at(static_cast<std::size_t>(count), 0),
        sum(static_cast<std::size_t>(count), 0),
        across(static_cast<std::size_t>(length)) {}

  void take(int line, int place, std::uint8_t grey) {
    const auto k = static_cast<std::size_t>(line);
    sum[k] += grey;
    if (grey > peak[k]) {
      peak[k] = grey;
      at[k] = place;
    }
  }
  /// A stripe is thin: the mean along its line is about the background.
  [[nodiscard]] int over(std::size_t line) const { return peak[line] - static_cast<int>(sum[line] / across); }
  [[nodiscard]] double seen_share() const {
    std::size_t seen = 0;
    for (std::size_t k = 0; k < peak.size(); ++k) {
      seen += over(k) >= kLeastPeak ? 1 : 0;
    }
    return static_cast<double>(seen) / static_cast<double>(peak.size());
  }
};

Exposure judge_photograph(const std::array<std::size_t, 256>& histogram, double pixels) {
  const auto share = [&](int from, int to) {
    std::size_t count = 0;
    for (int grey = from; grey <= to; ++grey) {
      count += histogram[static_cast<std::size_t>(grey)];
    }
    return static_cast<double>(count) / pixels;
  };
  Exposure out;
  out.saturated_share = share(kSaturatedFrom, 255);
  out.dark_share = share(0, kBlackTo);
  out.advice = out.saturated_share > kMostSaturated ? ExposureAdvice::kTooLong
               : share(kDim, 255) < kLeastBright    ? ExposureAdvice::kTooShort
                                                    : ExposureAdvice::kGood;
  return out;
}

Exposure judge_stripe(const Lines& lines) {
  std::size_t seen = 0;
  std::size_t saturated = 0;
  std::size_t weak = 0;
  for (std::size_t k = 0; k < lines.peak.size(); ++k) {
    const bool shows = lines.over(k) >= kLeastPeak;
    seen += shows ? 1 : 0;
    saturated += shows && lines.peak[k] >= kSaturatedFrom ? 1 : 0;
    weak += shows && lines.over(k) < kWeakPeak ? 1 : 0;
  }
  Exposure out;
  out.has_stripe = true;
  out.saturated_share = static_cast<double>(saturated) / static_cast<double>(seen);
  out.dark_share = static_cast<double>(weak) / static_cast<double>(seen);
  out.advice = out.saturated_share > kMostSaturated ? ExposureAdvice::kTooLong
               : out.dark_share > kMostWeak         ? ExposureAdvice::kTooShort
                                                    : ExposureAdvice::kGood;
  return out;
}

void mark(const GrayView& frame, const Exposure& is, const Lines& lines, bool per_column,
          std::vector<PixelMark>& marks) {
  const auto width = static_cast<std::size_t>(frame.width);
  marks.assign(width * static_cast<std::size_t>(frame.height), PixelMark::kPlain);
  for (int v = 0; v < frame.height; ++v) {
    const std::uint8_t* row = frame.row(v);
    for (int u = 0; u < frame.width; ++u) {
      const auto line = static_cast<std::size_t>(per_column ? u : v);
      const int off = (per_column ? v : u) - lines.at[line];
      const bool weak =
          lines.over(line) >= kLeastPeak && lines.over(line) < kWeakPeak && std::abs(off) <= kMarkedHalf;
      const bool dark = is.has_stripe ? weak : row[u] <= kBlackTo;
      marks[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] = row[u] >= kSaturatedFrom
                                                                                     ? PixelMark::kSaturated
                                                                                 : dark ? PixelMark::kDark
                                                                                        : PixelMark::kPlain;
    }
  }
}

}  // namespace

Exposure judge_exposure(const GrayView& frame, std::vector<PixelMark>* marks) {
  if (frame.empty()) {
    if (marks != nullptr) {
      marks->clear();
    }
    return {};
  }
  Lines columns(frame.width, frame.height);
  Lines rows(frame.height, frame.width);
  std::array<std::size_t, 256> histogram{};
  for (int v = 0; v < frame.height; ++v) {
    const std::uint8_t* row = frame.row(v);
    for (int u = 0; u < frame.width; ++u) {
      columns.take(u, v, row[u]);
      rows.take(v, u, row[u]);
      ++histogram[row[u]];
    }
  }
  // A stripe shows in every line that it crosses and in few of those along it.
  const bool per_column = columns.seen_share() >= rows.seen_share();
  const Lines& lines = per_column ? columns : rows;
  const double pixels = static_cast<double>(frame.width) * frame.height;
  std::size_t bright = 0;
  for (std::size_t grey = kWeakPeak; grey < histogram.size(); ++grey) {
    bright += histogram[grey];
  }
  const bool stripe =
      lines.seen_share() >= kLeastStripeShare && static_cast<double>(bright) <= kMostStripePixels * pixels;
  const Exposure out = stripe ? judge_stripe(lines) : judge_photograph(histogram, pixels);
  if (marks != nullptr) {
    mark(frame, out, lines, per_column, *marks);
  }
  return out;
}

}  // namespace dubsar
