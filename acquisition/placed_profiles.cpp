// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/placed_profiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "acquisition/rig_parts.h"
#include "acquisition/wall_clock.h"

namespace dubsar {

namespace {

/// Times the rows of the scan: a block of more than those has no time of its own.
constexpr std::size_t kMostOfBlock = 4;

}  // namespace

PlacedProfiles::PlacedProfiles(ProfileSink& sink, PositionTrack& track, Scan scan)
    : sink_(sink),
      track_(track),
      scan_(std::move(scan)),
      pitch_(scan_.step, scan_.speed, scan_.motion.kind != MotionKind::kLinear) {}

bool PlacedProfiles::begin(const ScanInfo& info) {
  info_ = info;
  if (info.timestamp_ns ==
      0) {  // the camera's profiles are timed on a clock that began when this machine did
    info_->timestamp_ns = wall_clock_ns();
  }
  flat_ = !info.view.motion_per_row_mm.isZero();
  return true;
}

/// Tells the sink of the scan, and hands on the rows that waited until it was known how far apart they come.
bool PlacedProfiles::begin_sink() {
  ScanInfo& out = *info_;
  const double pitch = pitch_.value();
  const bool linear = scan_.motion.kind == MotionKind::kLinear;
  out.view.motion_per_row_mm =
      linear ? Eigen::Vector3d(pitch * scan_.motion.direction) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const RigidTransform there =
      scan_.motion.zero_from_camera(scan_.motion.view_position(scan_.start, scan_.end()));
  for (std::optional<Eigen::Vector3d>* at : {&out.view.laser_mm, &out.view.camera_mm}) {
    if (*at) {
      *at = there * **at;
    }
  }
  out.view.direction = there.rotation * out.view.direction;
  out.expected_rows = scan_.rows;
  // On a turntable it goes by how far from the axis the clay is: by the grid's own samples.
  out.spacing_mm = linear ? std::max(out.spacing_mm, pitch * scan_.motion.direction.norm()) : 0.0;
  out.device = scan_.device;
  begun_ = sink_.begin(out);
  cancelled_ = !begun_;
  for (const auto& [row, timestamp_ns] : std::exchange(waiting_, {})) {
    if (!cancelled_) {
      give(row, timestamp_ns);
    }
  }
  return !cancelled_;
}

void PlacedProfiles::give(const Row& row, std::int64_t timestamp_ns) {
  Profile out;
  out.row = row.number - *first_row_;
  out.x = row.x;
  out.y = row.y;
  out.z = row.z;
  out.valid = row.valid;
  out.intensity = row.intensity;
  out.confidence = row.confidence;
  out.rgb = row.rgb;
  out.encoder = row.encoder;
  out.timestamp_ns = timestamp_ns;
  ++tally_.profiles_sent;
  cancelled_ = !sink_.profile(out);
}

bool PlacedProfiles::is_behind() const {
  const auto scan_rows = static_cast<std::size_t>(std::max(scan_.rows, 1));
  const bool at_rest = track_.closed_before(std::numeric_limits<std::int64_t>::max());
  return block_.size() >= kMostOfBlock * scan_rows || (at_rest && block_.size() >= 2 * scan_rows) ||
         track_.closed_before(block_ns_);
}

bool PlacedProfiles::profile(const Profile& profile) {
  if (profile.timestamp_ns == 0) {
    timeless_ = true;
    return false;
  }
  if (!block_.empty() && profile.timestamp_ns != block_ns_) {
    const auto rows = static_cast<double>(profile.row - block_.front().number);
    if (rows > 0) {
      period_ns_ = static_cast<double>(profile.timestamp_ns - block_ns_) / rows;
    }
    if (!hand_on()) {
      return false;
    }
  }
  block_ns_ = profile.timestamp_ns;
  Row row;
  row.number = profile.row;
  const auto keep = [](auto& to, const auto& from) { to.assign(from.begin(), from.end()); };
  keep(row.x, profile.x);
  keep(row.y, profile.y);
  keep(row.z, profile.z);
  keep(row.intensity, profile.intensity);
  keep(row.confidence, profile.confidence);
  keep(row.valid, profile.valid);
  keep(row.rgb, profile.rgb);
  row.encoder = profile.encoder;
  if (row.valid.empty()) {
    row.valid.assign(row.x.size(), 1);
  }
  block_.push_back(std::move(row));
  return !is_behind();
}

void PlacedProfiles::end(const ScanTally& tally) {
  tally_.profiles_dropped += tally.profiles_dropped;
  tally_.frames_repeated += tally.frames_repeated;
}

void PlacedProfiles::flush() {
  [[maybe_unused]] const bool more = hand_on();
  if (info_ && !begun_ && !cancelled_) {
    begin_sink();
  }
}

bool PlacedProfiles::hand_on() {
  std::vector<Row> block = std::exchange(block_, {});
  if (complete_ || cancelled_ || (block.size() > 1 && !period_ns_)) {
    return false;
  }
  for (std::size_t k = 0; k < block.size(); ++k) {
    const double later_ns =
        static_cast<double>(block[k].number - block.front().number) * period_ns_.value_or(0);
    if (!place(block[k], block_ns_ + static_cast<std::int64_t>(later_ns))) {
      return false;
    }
  }
  return true;
}

/// Where the stage was when the profiles before the first that was placed were taken nobody knows, or there
/// were none: rows that are lost, as RowCount has it. A profile placed before it was none of the scan.
void PlacedProfiles::begin_rows(std::int64_t row, double position) {
  if (first_row_) {
    return;
  }
  const double missed = sure_ ? 0.0 : std::floor((position - scan_.start) / scan_.step + 0.5);
  first_row_ = row - static_cast<std::int64_t>(std::max(0.0, missed));
  tally_.profiles_dropped += static_cast<std::uint64_t>(row - *first_row_);
}

/// Rows whose place was not known lie evenly between those around them: the ones inside the scan are lost.
void PlacedProfiles::count_unsure(std::int64_t row, double position) {
  for (const std::int64_t one : std::exchange(unsure_, {})) {
    const double pitch =
        sure_ ? (position - sure_->second) / static_cast<double>(row - sure_->first) : scan_.step;
    const double there = position - pitch * static_cast<double>(row - one);
    if (there >= scan_.start - 0.5 * scan_.step && there < scan_.end() + 0.5 * scan_.step) {
      begin_rows(one, there);
      ++tally_.profiles_dropped;
    }
  }
  if (position >= scan_.start - 0.5 * scan_.step && position < scan_.end() + 0.5 * scan_.step) {
    begin_rows(row, position);
  }
  sure_ = {row, position};
}

bool PlacedProfiles::place(Row& row, std::int64_t timestamp_ns) {
  const std::optional<PositionTrack::Place> there = track_.at(timestamp_ns);
  if (!there) {
    // Before it moved, or behind where it came to rest.
    return !track_.closed_before(timestamp_ns);
  }
  if (there->sigma > kSureSteps * scan_.step) {
    unsure_.push_back(row.number);
    return true;
  }
  const double position = there->position;
  position_ = position;
  count_unsure(row.number, position);
  if (position < scan_.start - 0.5 * scan_.step) {
    return true;
  }
  if (position >= scan_.end() + 0.5 * scan_.step) {
    complete_ = true;
    return false;
  }
  complete_ = position >= scan_.end() - 0.5 * scan_.step;
  const RigidTransform zero_from_camera = scan_.motion.zero_from_camera(position);
  for (std::size_t i = 0; i < row.x.size(); ++i) {
    if (row.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3d p = zero_from_camera * Eigen::Vector3d(static_cast<double>(row.x[i]),
                                                                 flat_ ? 0.0 : static_cast<double>(row.y[i]),
                                                                 static_cast<double>(row.z[i]));
    row.x[i] = static_cast<float>(p.x());
    row.y[i] = static_cast<float>(p.y());
    row.z[i] = static_cast<float>(p.z());
  }
  pitch_.add(row.number, timestamp_ns, position);
  if (begun_) {
    give(row, timestamp_ns);
  } else {
    waiting_.emplace_back(std::move(row), timestamp_ns);
    if (pitch_.is_known()) {
      begin_sink();
    }
  }
  return !cancelled_ && !complete_;
}

}  // namespace dubsar
