// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/range_source.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "acquisition/rig_device.h"
#include "acquisition/stops_when_cancelled.h"

namespace dubsar {

namespace {

/// Puts the chunks of an unordered scan together. A channel that some chunk lacks is given up.
class CloudBuilder {
 public:
  void append(const Profile& profile) {
    const std::size_t n = profile.x.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (!profile.valid.empty() && profile.valid[i] == 0) {
        continue;
      }
      cloud_.points.emplace_back(profile.x[i], profile.y[i], profile.z[i]);
      if (!profile.normals.empty()) {
        cloud_.normals.emplace_back(profile.normals[3 * i], profile.normals[3 * i + 1],
                                    profile.normals[3 * i + 2]);
      }
      if (!profile.intensity.empty()) {
        cloud_.intensity.push_back(profile.intensity[i]);
      }
      for (std::size_t k = 0; k < 3 && !profile.rgb.empty(); ++k) {
        cloud_.rgb.push_back(profile.rgb[3 * i + k]);
      }
    }
  }

  [[nodiscard]] PointCloud take() {
    const std::size_t n = cloud_.points.size();
    if (cloud_.normals.size() != n) {
      cloud_.normals.clear();
    }
    if (cloud_.intensity.size() != n) {
      cloud_.intensity.clear();
    }
    if (cloud_.rgb.size() != 3 * n) {
      cloud_.rgb.clear();
    }
    return std::move(cloud_);
  }

 private:
  PointCloud cloud_;
};

class Collector : public ProfileSink {
 public:
  Collector(const RangeSource::RowObserver& observer, std::vector<std::string>& remarks, JobContext& job,
            const std::atomic<bool>& halted)
      : observer_(observer), remarks_(remarks), job_(job), halted_(halted) {}

  bool begin(const ScanInfo& info) override {
    info_ = info;
    if (info.organised) {
      builder.emplace(info);
    } else {
      cloud.emplace();
    }
    return !ended();
  }
  bool profile(const Profile& profile) override {
    if (ended()) {
      return false;
    }
    if (cloud) {
      cloud->append(profile);
    } else if (builder->append(profile)) {
      show_row();
    }
    return true;
  }
  void end(const ScanTally& ended) override { tally = ended; }
  void remark(const std::string& text) override { remarks_.push_back(text); }

  /// Hands a grid on row by row as if it came from the device.
  Status replay(const RangeGrid& grid) {
    info_.organised = true;
    info_.cols = grid.cols;
    info_.expected_rows = grid.rows;
    info_.spacing_mm = grid.spacing_mm;
    info_.view = grid.view;
    builder.emplace(info_);
    const auto cols = static_cast<std::size_t>(grid.cols);
    for (int row = 0; row < grid.rows; ++row) {
      if (ended()) {
        return fail(ErrorKind::kCancelled, "scan cancelled", info_.source);
      }
      const auto part = [&](const auto& channel, std::size_t per) {
        return channel.empty() ? std::span(channel)
                               : std::span(channel).subspan(grid.index(row, 0) * per, cols * per);
      };
      Profile profile;
      profile.row = row;
      profile.x = part(grid.x, 1);
      profile.y = part(grid.y, 1);
      profile.z = part(grid.z, 1);
      profile.valid = part(grid.valid, 1);
      profile.intensity = part(grid.intensity, 1);
      profile.rgb = part(grid.rgb, 3);
      builder->append(profile);
      show_row();
    }
    return {};
  }

  [[nodiscard]] const ScanInfo& info() const { return info_; }

  std::optional<GridBuilder> builder;
  std::optional<CloudBuilder> cloud;
  ScanTally tally;

 private:
  [[nodiscard]] bool ended() const { return job_.cancelled() || halted_; }
  void show_row() {
    if (observer_) {
      observer_(builder->grid(), builder->grid().rows - 1);
    }
  }

  const RangeSource::RowObserver& observer_;
  std::vector<std::string>& remarks_;
  JobContext& job_;
  const std::atomic<bool>& halted_;
  ScanInfo info_;
};

}  // namespace

std::string losses_of(const ScanRecord& record) {
  std::string out;
  const auto count = [&](const char* what, std::uint64_t n) {
    if (n > 0) {
      out += (out.empty() ? "not all of it came as it was measured: " : ", ") + std::string(what) +
             std::to_string(n);
    }
  };
  // A driver that counts what it dropped leaves a gap in its rows as well, but behind the last.
  count("rows lost: ", std::max(record.tally.profiles_dropped, record.faults.rows_lost));
  count("rows that came twice: ", record.faults.rows_repeated);
  count("rows of another length: ", record.faults.odd_lengths);
  count("samples that are no places: ", record.faults.bad_samples);
  return out;
}

template <class Call>
auto RangeSource::watched(const JobContext& job, const Call& call) {
  StopsWhenCancelled watch(device_, job, halted_.get());
  auto answer = call();
  note_stop(watch.end());
  if ((job.cancelled() || *halted_) && !stop_refused_) {
    // Who made the call end may have seen it before the watch did; and a camera has answered only now.
    note_stop(device_.stop());
  }
  return answer;
}

Status RangeSource::place(const Placement& placement, JobContext& job) {
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped before the move", uri_.text());
  }
  if (const auto halt = halted_before(job)) {
    return std::unexpected(*halt);
  }
  const Status placed = watched(job, [&] { return device_.place(placement); });
  const auto ended = ended_by_hand(job);
  return ended ? std::unexpected(*ended) : placed;
}

Status RangeSource::stop() {
  note_stop(device_.stop());
  const auto refused = unstopped();
  return refused ? std::unexpected(*refused) : Status{};
}

void RangeSource::note_stop(const Status& answer) {
  stop_refused_ = not_obeyed(answer, *halted_) ? std::optional(answer.error()) : std::nullopt;
}

std::optional<Error> RangeSource::unstopped() const {
  return stop_refused_ ? not_obeyed(std::unexpected(*stop_refused_), *halted_) : std::nullopt;
}

std::optional<Error> RangeSource::halted_before(const JobContext& job) {
  if (job.halted()) {
    halt();
  }
  if (*halted_) {
    [[maybe_unused]] const Status said = stop();  // halted() knows
  }
  return halted();
}

std::optional<Error> RangeSource::ended_by_hand(const JobContext& job) const {
  if (job.halted()) {
    halt();
  }
  return job.cancelled() && !*halted_ ? unstopped() : halted();
}

std::optional<Error> RangeSource::halted() const {
  if (!*halted_) {
    return std::nullopt;
  }
  return unstopped().value_or(
      Error{ErrorKind::kDevice,
            "the emergency stop was pressed: lasers are off and nothing moves",
            {},
            "see that all is clear, then scan: a stage with switches is homed first"});
}

RangeSource::RangeSource(DeviceUri uri, Device device, DeviceCapabilities capabilities,
                         ResampleOptions resampling)
    : uri_(std::move(uri)),
      device_(std::move(device)),
      capabilities_(std::move(capabilities)),
      resampling_(std::move(resampling)) {}

Result<RangeSource> RangeSource::open(std::string_view text, const DriverRegistry& registry,
                                      const ResampleOptions& resampling) {
  if (Status checked = resampling.check(); !checked) {
    return std::unexpected(checked.error());
  }
  Result<DeviceUri> uri = parse_device_uri(text);
  if (!uri) {
    return std::unexpected(uri.error());
  }
  Result<Device> device = open_device(*uri, registry);
  if (!device) {
    return std::unexpected(device.error());
  }
  Result<DeviceCapabilities> capabilities = device->capabilities();
  if (!capabilities) {
    return std::unexpected(capabilities.error());
  }
  if (uri->scheme == "rig" && capabilities->rig) {
    capabilities->rig->calibration_check = last_verification(uri->locator);
  }
  return RangeSource(std::move(*uri), std::move(*device), std::move(*capabilities), resampling);
}

Result<std::optional<RangeGrid>> RangeSource::next(const RowObserver& observer, JobContext& job) {
  partial_.reset();
  record_ = {};
  if (const auto halt = halted_before(job)) {
    return std::unexpected(*halt);
  }
  Collector collector(observer, record_.remarks, job, *halted_);
  const Result<ScanOutcome> outcome = watched(job, [&] { return device_.scan(collector); });
  record_.tally = collector.tally;
  record_.file = collector.info().file;
  std::optional<Error> fault = outcome ? std::nullopt : std::optional(outcome.error());
  if (fault || stop_refused_) {
    const std::optional<Error> ended = ended_by_hand(job);
    fault = ended ? ended : fault;
  }
  if (outcome && *outcome == ScanOutcome::kExhausted) {
    return std::optional<RangeGrid>();
  }
  if (!fault && collector.cloud) {
    record_.resampled = true;
    PointCloud cloud = collector.cloud->take();
    cloud.source = collector.info().source;
    ResampleOptions options = resampling_;
    if (options.spacing_mm == 0) {
      options.spacing_mm = collector.info().spacing_mm;
    }
    const Result<RangeGrid> grid = resample(cloud, options, job);
    const Status replayed = grid ? collector.replay(*grid) : std::unexpected(grid.error());
    if (!replayed) {
      fault = replayed.error();
    }
  }
  if (collector.builder) {
    record_.faults = collector.builder->faults();
    collector.builder->estimate_spacing();
  }
  const bool some_rows = collector.builder && collector.builder->grid().rows > 0;
  if (fault) {
    if (some_rows) {
      partial_ = collector.builder->take();
    }
    return std::unexpected(std::move(*fault));
  }
  if (!some_rows) {
    return fail(ErrorKind::kDevice, "the scan came without a single profile", uri_.text(),
                "see whether the tablet lies in the measuring range and scan again");
  }
  return std::optional(collector.builder->take());
}

}  // namespace dubsar
