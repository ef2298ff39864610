// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/grid_builder.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

/// A longer gap is a row number gone wrong rather than lost rows; the rows then go on without it.
constexpr std::int64_t kLongestGap = 10000;
/// Announced sizes and gaps are believed up to so many samples; beyond it memory is taken as rows come.
constexpr std::size_t kMostSamples = std::size_t{1} << 27U;
constexpr float kFarthestMm = 1e6F;
/// A profile's time is of a clock that places it on a stage's way, and that began when the machine did: what
/// lies before is no date.
constexpr std::int64_t kYear2000Ns = 946'684'800'000'000'000;

/// A channel appears with its first profile; rows before it hold `fill`.
template <class T>
void append_channel(std::vector<T>& channel, std::span<const T> row, std::size_t had, std::size_t cols,
                    std::size_t per, T fill) {
  if (row.empty() && channel.empty()) {
    return;
  }
  channel.resize(had * per, fill);
  const std::size_t count = std::min(row.size(), cols * per);
  channel.insert(channel.end(), row.begin(), row.begin() + static_cast<std::ptrdiff_t>(count));
  channel.resize((had + cols) * per, fill);
}

void clamp_to_unit(std::vector<float>& channel, std::size_t from, float fill) {
  for (std::size_t i = from; i < channel.size(); ++i) {
    channel[i] = std::isfinite(channel[i]) ? std::clamp(channel[i], 0.0F, 1.0F) : fill;
  }
}

}  // namespace

GridBuilder::GridBuilder(const ScanInfo& info) : spacing_known_(info.spacing_mm > 0) {
  grid_.cols = info.cols;
  grid_.spacing_mm = info.spacing_mm;
  grid_.view = info.view;
  grid_.nominal = info.nominal;
  grid_.pin_tip_diameter_mm = info.pin_tip_diameter_mm;
  grid_.timestamp_ns = info.timestamp_ns;
  grid_.device = info.device;
  grid_.source = info.source;
  const std::size_t expected = std::min(
      kMostSamples, static_cast<std::size_t>(info.expected_rows) * static_cast<std::size_t>(info.cols));
  for (std::vector<float>* axis : {&grid_.x, &grid_.y, &grid_.z}) {
    axis->reserve(expected);
  }
  grid_.valid.reserve(expected);
}

void GridBuilder::append_empty_rows(std::size_t count) {
  grid_.rows += static_cast<int>(count);
  const std::size_t n = static_cast<std::size_t>(grid_.rows) * static_cast<std::size_t>(grid_.cols);
  for (std::vector<float>* axis : {&grid_.x, &grid_.y, &grid_.z}) {
    axis->resize(n, 0.0F);
  }
  grid_.valid.resize(n, 0);
  grid_.intensity.resize(grid_.intensity.empty() ? 0 : n, 0.0F);
  grid_.confidence.resize(grid_.confidence.empty() ? 0 : n, 0.0F);
  grid_.rgb.resize(grid_.rgb.empty() ? 0 : 3 * n, 0);
}

bool GridBuilder::append(const Profile& profile) {
  if (profile.row < grid_.rows) {
    ++faults_.rows_repeated;
    return false;
  }
  if (const std::int64_t gap = profile.row - grid_.rows; gap > 0) {
    faults_.rows_lost += static_cast<std::uint64_t>(gap);
    const auto rows = static_cast<std::size_t>(gap);
    const bool sane = gap <= kLongestGap && rows * static_cast<std::size_t>(grid_.cols) <= kMostSamples;
    append_empty_rows(sane ? rows : 0);
  }
  const std::size_t had = grid_.size();
  const auto cols = static_cast<std::size_t>(grid_.cols);
  const std::size_t count = std::min(profile.x.size(), cols);
  faults_.odd_lengths += profile.x.size() != cols ? 1 : 0;
  append_empty_rows(1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!profile.valid.empty() && profile.valid[i] == 0) {
      continue;
    }
    const float x = profile.x[i];
    const float y = profile.y[i];
    const float z = profile.z[i];
    // Written so that a NaN fails.
    if (!(std::abs(x) <= kFarthestMm && std::abs(y) <= kFarthestMm && std::abs(z) <= kFarthestMm)) {
      ++faults_.bad_samples;
      continue;
    }
    grid_.x[had + i] = x;
    grid_.y[had + i] = y;
    grid_.z[had + i] = z;
    grid_.valid[had + i] = 1;
  }
  append_channel(grid_.intensity, profile.intensity, had, cols, 1, 0.0F);
  append_channel(grid_.confidence, profile.confidence, had, cols, 1, 1.0F);
  append_channel(grid_.rgb, profile.rgb, had, cols, 3, std::uint8_t{0});
  clamp_to_unit(grid_.intensity, std::min(had, grid_.intensity.size()), 0.0F);
  clamp_to_unit(grid_.confidence, std::min(had, grid_.confidence.size()), 0.0F);
  if (grid_.timestamp_ns == 0 && profile.timestamp_ns >= kYear2000Ns) {
    grid_.timestamp_ns = profile.timestamp_ns;
  }
  if (!spacing_known_ && grid_.rows >= next_estimate_) {
    estimate_spacing();
    next_estimate_ = 2 * grid_.rows;
  }
  return true;
}

void GridBuilder::estimate_spacing() {
  if (!spacing_known_) {
    grid_.spacing_mm = estimate_spacing_mm(grid_);
  }
}

}  // namespace dubsar
