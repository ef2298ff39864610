// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// replay: plays recorded scans as if a scanner made them now, profile by profile.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "core/job.h"
#include "core/log.h"
#include "core/units.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "drivers/replay/scan_files.h"

struct dubsar_device {
  dubsar::replay::ScanFiles files;
  double rate_per_s = 0;                  ///< 0: as fast as can be
  std::mutex mutex{};                     ///< of what follows
  dubsar::JobContext* reading = nullptr;  ///< of a file, which stop() ends
};

namespace {

using namespace dubsar;
using Clock = std::chrono::steady_clock;

/// Points of an unordered scan per call.
constexpr std::size_t kChunk = 4096;
/// A cancelled scan must not sleep through a slow rate: the sink is asked at every profile, at most this
/// late.
constexpr double kSlowestRate = 1.0;

const plugin::SettingRow kOptions[] = {
    {DUBSAR_TYPE_CHOICE, "unit", "what the numbers in the files are; without it the file's own word, else mm",
     nullptr, "m|cm|mm|um|in"},
    {DUBSAR_TYPE_NUMBER, "rate", "profiles per second; 0 is as fast as can be", "1/s", nullptr, 0.0, 1e6},
};
const plugin::SettingRow kSettings[] = {
    {DUBSAR_TYPE_NUMBER, "rate", "profiles per second; 0 is as fast as can be", "1/s", nullptr, 0.0, 1e6},
};

bool is_rate(double rate) {
  return rate == 0 || (rate >= kSlowestRate && rate <= 1e6);
}

/// Keeps profiles to their rate against the start, so that a slow receiver does not add up.
class Pace {
 public:
  explicit Pace(const double& rate_per_s) : rate_per_s_(rate_per_s) {}
  void wait() {
    if (rate_per_s_ > 0) {
      std::this_thread::sleep_until(start_ + std::chrono::duration_cast<Clock::duration>(
                                                 std::chrono::duration<double>(sent_ / rate_per_s_)));
    }
    sent_ += 1;
  }

 private:
  const double& rate_per_s_;
  Clock::time_point start_ = Clock::now();
  double sent_ = 0;
};

std::int32_t finish(const dubsar_sink& sink, bool cancelled, std::uint64_t sent) {
  const std::int32_t code = cancelled ? DUBSAR_CANCELLED : DUBSAR_OK;
  const dubsar_scan_end end{sizeof end, code, sent, 0, 0};
  sink.end(sink.user, &end);
  return code;
}

using Remarks = std::vector<std::string>;

/// An older program takes no remarks: they stand in its log.
void tell(const dubsar_sink& sink, const std::string& scan, const Remarks& remarks) {
  for (const std::string& one : remarks) {
    if (!plugin::remark(sink, one)) {
      log_warning(scan + ": " + one);
    }
  }
}

/// A scan of a file, and what there is to say of it.
struct Played {
  std::string file;
  Remarks remarks;
};

std::int32_t send_grid(const RangeGrid& grid, const Played& played, Pace pace, const dubsar_sink& sink) {
  dubsar_scan_info info = plugin::scan_info_of(grid);
  info.file = played.file.c_str();
  if (!(info.spacing_mm > 0)) {
    info.spacing_mm = estimate_spacing_mm(grid);
  }
  if (sink.begin(sink.user, &info) != 0) {
    return finish(sink, true, 0);
  }
  tell(sink, grid.source, played.remarks);
  for (int row = 0; row < grid.rows; ++row) {
    pace.wait();
    const dubsar_profile profile = plugin::profile_of(grid, row);
    if (sink.profile(sink.user, &profile) != 0) {
      return finish(sink, true, static_cast<std::uint64_t>(row));
    }
  }
  return finish(sink, false, static_cast<std::uint64_t>(grid.rows));
}

std::int32_t send_cloud(const PointCloud& cloud, const Played& played, Pace pace, const dubsar_sink& sink) {
  dubsar_scan_info info{};
  info.struct_size = sizeof info;
  info.flags = DUBSAR_SCAN_UNORDERED;
  info.view = plugin::view_of({});
  info.source = cloud.source.c_str();
  info.file = played.file.c_str();
  if (sink.begin(sink.user, &info) != 0) {
    return finish(sink, true, 0);
  }
  tell(sink, cloud.source, played.remarks);
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  std::uint64_t sent = 0;
  for (std::size_t at = 0; at < cloud.points.size(); at += kChunk) {
    const std::size_t count = std::min(kChunk, cloud.points.size() - at);
    x.clear();
    y.clear();
    z.clear();
    for (std::size_t i = at; i < at + count; ++i) {
      x.push_back(cloud.points[i].x());
      y.push_back(cloud.points[i].y());
      z.push_back(cloud.points[i].z());
    }
    dubsar_profile profile{};
    profile.struct_size = sizeof profile;
    profile.count = static_cast<std::uint32_t>(count);
    profile.row = static_cast<std::int64_t>(sent);
    profile.x = x.data();
    profile.y = y.data();
    profile.z = z.data();
    profile.intensity = cloud.intensity.empty() ? nullptr : cloud.intensity.data() + at;
    profile.rgb = cloud.rgb.empty() ? nullptr : cloud.rgb.data() + 3 * at;
    profile.normals = cloud.normals.empty() ? nullptr : cloud.normals[at].data();
    pace.wait();
    if (sink.profile(sink.user, &profile) != 0) {
      return finish(sink, true, sent);
    }
    ++sent;
  }
  return finish(sink, false, sent);
}

std::int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* /*error*/) {
  return plugin::describe(kOptions, callback, user);
}

std::int32_t discover(dubsar_device_callback /*callback*/, void* /*user*/, dubsar_error* /*error*/) {
  return DUBSAR_OK;  // What could be played is everywhere.
}

std::int32_t open(const char* locator, const dubsar_option* options, std::uint32_t count,
                  dubsar_device** device, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    GridReadOptions reading;
    double rate = 0;
    for (const dubsar_option& option : std::span(options, count)) {
      const std::string_view key = option.key;
      const std::string value = option.value;
      if (key == "unit") {
        reading.mm_per_unit = mm_per_unit(value);
        if (!reading.mm_per_unit) {
          return plugin::report(error, DUBSAR_USAGE, "unit '" + value + "' is none", {},
                                "write " + std::string(kLengthUnitsText));
        }
      } else if (key == "rate") {
        const std::optional<double> number = plugin::number(value);
        if (!number || !is_rate(*number)) {
          return plugin::report(error, DUBSAR_USAGE, "rate '" + value + "' is none", {},
                                "write profiles per second from 1 to 1000000, or 0");
        }
        rate = *number;
      }
    }
    if (*locator == '\0') {
      return plugin::report(error, DUBSAR_USAGE, "nothing to play",
                            "replay:", "name a folder or a file of range grids after the colon");
    }
    Result<replay::ScanFiles> files = replay::ScanFiles::open(locator, reading);
    if (!files) {
      return plugin::report(error, files.error());
    }
    if (!files->passed_over().empty()) {
      log_info(std::string(locator) + ": " + files->passed_over());
    }
    *device = new dubsar_device{std::move(*files), rate};
    return DUBSAR_OK;
  });
}

void close(dubsar_device* device) {
  delete device;
}

std::int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* /*error*/) {
  dubsar_capabilities filled{};
  filled.flags = DUBSAR_IS_FINITE;
  filled.scan_count = device->files.count().value_or(-1);
  plugin::lend(out, filled);
  return DUBSAR_OK;
}

std::int32_t describe_settings(dubsar_device* /*device*/, dubsar_setting_callback callback, void* user,
                               dubsar_error* /*error*/) {
  return plugin::describe(kSettings, callback, user);
}

std::int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  if (std::string_view(key) != "rate") {
    return plugin::report(error, DUBSAR_USAGE, "no such setting", key, "there is rate");
  }
  dubsar_value filled{};
  filled.type = DUBSAR_TYPE_NUMBER;
  filled.number = device->rate_per_s;
  plugin::lend(value, filled);
  return DUBSAR_OK;
}

std::int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) {
  if (std::string_view(key) != "rate" || value->type != DUBSAR_TYPE_NUMBER || !is_rate(value->number)) {
    return plugin::report(error, DUBSAR_USAGE, "rate is a number from 1 to 1000000, or 0", key);
  }
  device->rate_per_s = value->number;
  return DUBSAR_OK;
}

/// A large file takes long, and no sink can be asked meanwhile whether to go on. Whoever wants it stopped
/// before it has begun says so again.
class Reading {
 public:
  explicit Reading(dubsar_device& device) : device_(device) { tell(&job_); }
  ~Reading() { tell(nullptr); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  Result<std::optional<ScanData>> next() { return device_.files.next(job_); }

 private:
  void tell(JobContext* job) {
    const std::scoped_lock lock(device_.mutex);
    device_.reading = job;
  }
  dubsar_device& device_;
  JobContext job_;
};

std::int32_t stop(dubsar_device* device, dubsar_error* /*error*/) {
  const std::scoped_lock lock(device->mutex);
  if (device->reading != nullptr) {
    device->reading->cancel();
  }
  return DUBSAR_OK;
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Result<std::optional<ScanData>> data = Reading(*device).next();
    if (!data) {
      return plugin::report(error, data.error());
    }
    if (!*data) {
      return DUBSAR_END;
    }
    const Pace pace(device->rate_per_s);
    const auto* grid = std::get_if<RangeGrid>(&**data);
    const auto* cloud = std::get_if<PointCloud>(&**data);
    const Played played{device->files.file().string(),
                        device->files.remarks_on(grid != nullptr ? grid->source : cloud->source)};
    const std::int32_t code =
        grid != nullptr ? send_grid(*grid, played, pace, *sink) : send_cloud(*cloud, played, pace, *sink);
    return code == DUBSAR_OK ? code : plugin::report(error, DUBSAR_CANCELLED, "scan cancelled");
  });
}

constexpr dubsar_driver kDriver = [] {
  dubsar_driver out = plugin::empty_driver();
  out.scheme = "replay";
  out.description = "recorded range grids, played as if they were scanned now";
  out.version = "1";
  out.locator_help = "a folder or a file of range grids (PLY, PTX, points, Dubsar grids)";
  out.describe_options = describe_options;
  out.discover = discover;
  out.open = open;
  out.close = close;
  out.capabilities = capabilities;
  out.describe_settings = describe_settings;
  out.get_setting = get_setting;
  out.set_setting = set_setting;
  out.scan = scan;
  out.stop = stop;
  return out;
}();

}  // namespace

const dubsar_driver* dubsar_driver_entry() {
  return &kDriver;
}
