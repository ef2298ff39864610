// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/position_track.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace dubsar {

namespace {

constexpr std::size_t kSide = 6;   // readings on either side that a position is fitted to
constexpr std::size_t kAhead = 4;  // of them that must be there before one is told
constexpr double kClockS = 1e-4;   // what no reading is better than

}  // namespace

void PositionTrack::add(std::int64_t timestamp_ns, double position, std::int64_t uncertainty_ns) {
  {
    const std::lock_guard lock(mutex_);
    if (!readings_.empty() && timestamp_ns <= readings_.back().timestamp_ns) {
      return;
    }
    readings_.push_back({timestamp_ns, position, 1e-9 * static_cast<double>(uncertainty_ns) + kClockS});
  }
  more_.notify_all();
}

void PositionTrack::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  more_.notify_all();
}

std::optional<double> PositionTrack::last() const {
  const std::lock_guard lock(mutex_);
  return readings_.empty() ? std::nullopt : std::optional(readings_.back().position);
}

bool PositionTrack::wait_closed(std::chrono::milliseconds at_most) {
  std::unique_lock lock(mutex_);
  return more_.wait_for(lock, at_most, [this] { return closed_; });
}

bool PositionTrack::closed_before(std::int64_t timestamp_ns) const {
  const std::lock_guard lock(mutex_);
  return closed_ && (readings_.empty() || readings_.back().timestamp_ns < timestamp_ns);
}

std::optional<PositionTrack::Place> PositionTrack::at(std::int64_t timestamp_ns) {
  std::unique_lock lock(mutex_);
  std::size_t after = 0;
  more_.wait(lock, [&] {
    const auto found = std::ranges::lower_bound(readings_, timestamp_ns, {}, &Reading::timestamp_ns);
    after = static_cast<std::size_t>(found - readings_.begin());
    return closed_ || readings_.size() - after >= kAhead;
  });
  if (after == readings_.size() || (after == 0 && readings_.front().timestamp_ns != timestamp_ns)) {
    return std::nullopt;
  }
  return fitted(after, timestamp_ns);
}

PositionTrack::Place PositionTrack::fitted(std::size_t after, std::int64_t timestamp_ns) const {
  const std::size_t from = after > kSide ? after - kSide : 0;
  const std::size_t to = std::min(readings_.size(), after + kSide);
  const int terms = to - from >= 6 ? 3 : to - from >= 2 ? 2 : 1;
  // A reading's error is its uncertainty times the speed, which is about the same for all of them here.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double origin = readings_[after].position;
  for (std::size_t k = from; k < to; ++k) {
    const Reading& one = readings_[k];
    const double t = 1e-9 * static_cast<double>(one.timestamp_ns - timestamp_ns);
    const double sigma_s = one.uncertainty_s / std::numbers::sqrt3;  // anywhere between question and answer
    const double weight = 1 / (sigma_s * sigma_s);
    const Eigen::Vector3d row(1, t, t * t);
    normal += weight * row * row.transpose();
    right += weight * (one.position - origin) * row;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal.topLeftCorner(terms, terms));
  const Eigen::VectorXd solved = solver.solve(right.head(terms));
  const double variance_s2 = solver.solve(Eigen::VectorXd::Unit(terms, 0))(0);
  const double speed = terms > 1 ? std::abs(solved(1)) : 0;
  return {origin + solved(0), speed * std::sqrt(std::max(0.0, variance_s2))};
}

}  // namespace dubsar
