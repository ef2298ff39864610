// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_device.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "acquisition/camera_region.h"
#include "acquisition/device_uri.h"
#include "acquisition/range_rig.h"
#include "acquisition/rig_log.h"
#include "acquisition/rig_view.h"
#include "core/log.h"
#include "core/number_text.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"

namespace dubsar {

namespace {

/// Hands a scan on through the C sink.
class SinkBridge : public ProfileSink {
 public:
  explicit SinkBridge(const dubsar_sink& sink) : sink_(sink) {}

  bool begin(const ScanInfo& info) override {
    dubsar_scan_info out{};
    out.struct_size = sizeof out;
    out.cols = info.cols;
    out.expected_rows = info.expected_rows;
    out.spacing_mm = info.spacing_mm;
    out.view = plugin::view_of(info.view);
    out.timestamp_ns = info.timestamp_ns;
    out.device_id = info.device.c_str();
    return sink_.begin(sink_.user, &out) == 0;
  }
  bool profile(const Profile& profile) override {
    dubsar_profile out{};
    out.struct_size = sizeof out;
    out.count = static_cast<std::uint32_t>(profile.x.size());
    out.row = profile.row;
    out.x = profile.x.data();
    out.y = profile.y.data();
    out.z = profile.z.data();
    out.valid = profile.valid.data();
    out.intensity = profile.intensity.data();
    out.confidence = profile.confidence.data();
    out.rgb = profile.rgb.data();
    out.timestamp_ns = profile.timestamp_ns;
    out.flags = profile.encoder ? DUBSAR_PROFILE_ENCODER : 0;
    out.encoder = profile.encoder.value_or(0);
    return sink_.profile(sink_.user, &out) == 0;
  }
  void end(const ScanTally& tally) override {
    tally_ = tally;
    begun_ = true;
  }

  void remark(const std::string& text) override {
    if (!plugin::remark(sink_, text)) {
      log_warning(text);
    }
  }

  void finish(std::int32_t code) {
    if (begun_) {
      dubsar_scan_end out{};
      out.struct_size = sizeof out;
      out.code = code;
      out.profiles_sent = tally_.profiles_sent;
      out.profiles_dropped = tally_.profiles_dropped;
      out.frames_repeated = tally_.frames_repeated;
      sink_.end(sink_.user, &out);
    }
  }

 private:
  const dubsar_sink& sink_;
  ScanTally tally_;
  bool begun_ = false;
};

std::int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  return plugin::fenced(error, [&] {
    const Rig* const rig = device->source->geometry();
    dubsar_capabilities unknown{};
    unknown.struct_size = sizeof unknown;
    unknown.scan_count = -1;
    unknown.calibration_age_days = -1;
    dubsar_capabilities filled = rig != nullptr ? plugin::capabilities_of(*rig) : unknown;
    if (Device* const camera = device->source->camera()) {
      filled.flags |= DUBSAR_YIELDS_FRAMES;
      const Result<DeviceCapabilities> capable = camera->capabilities();
      plugin::copy_text(filled.serial, capable ? capable->serial : std::string());
    }
    plugin::lend(out, filled);
    return std::int32_t{DUBSAR_OK};
  });
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  return plugin::fenced(error, [&] {
    SinkBridge bridge(*sink);
    const std::int32_t code = plugin::answer(device->source->scan(bridge), error);
    bridge.finish(code);
    return code;
  });
}

std::int32_t stop(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->source->stop(), error); });
}

std::int32_t emergency_stop(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->source->halt(), error); });
}

std::int32_t nothing(dubsar_setting_callback, void*, dubsar_error*) {
  return DUBSAR_OK;
}

std::int32_t discover(dubsar_device_callback, void*, dubsar_error*) {
  return DUBSAR_OK;
}

std::int32_t open_by_name(const char*, const dubsar_option*, std::uint32_t, dubsar_device**,
                          dubsar_error* error) {
  return plugin::report(error, DUBSAR_USAGE, "a rig is put together, not opened");
}

void close(dubsar_device* device) {
  delete device;
}

const dubsar_driver& rig_driver() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = plugin::empty_driver();
    out.scheme = "rig";
    out.description = "camera, stage and calibration put together";
    out.version = "1";
    out.locator_help = "rig.toml";
    out.describe_options = nothing;
    out.discover = discover;
    out.open = open_by_name;
    out.close = close;
    out.capabilities = capabilities;
    out.scan = scan;
    out.stop = stop;
    out.emergency_stop = emergency_stop;
    offer_view(out);
    return out;
  }();
  return driver;
}

/// `endless`: a range camera goes on until it is told to stop, where its driver counts profiles and the URI
/// says nothing of them; and how far apart its rows lie it need not know, for the stage says where they are.
Result<Device> part(const std::string& uri_text, const DriverRegistry& registry, bool endless) {
  Result<DeviceUri> uri = parse_device_uri(uri_text);
  if (!uri) {
    return std::unexpected(uri.error());
  }
  if (uri->scheme == "rig") {
    return fail(ErrorKind::kUsage, "a rig cannot be a part of a rig", uri_text);
  }
  const Result<const Driver*> driver = registry.find(uri->scheme);
  const Result<std::vector<SettingInfo>> options =
      driver ? (*driver)->options() : std::unexpected(driver.error());
  if (endless && options) {
    const auto unsaid = [&](const std::string& key) -> const SettingInfo* {
      const auto option = std::ranges::find(*options, key, &SettingInfo::key);
      const bool said = std::ranges::any_of(uri->options, [&](const auto& one) { return one.first == key; });
      return option != options->end() && !said ? &*option : nullptr;
    };
    if (const SettingInfo* const rows = unsaid("rows"); rows != nullptr && rows->range) {
      uri->options.emplace_back("rows", std::to_string(static_cast<std::int64_t>(rows->range->second)));
    }
    if (const SettingInfo* const row = unsaid("row"); row != nullptr && row->unit == "mm") {
      uri->options.emplace_back("row", "1");
    }
  }
  return open_device(*uri, registry);
}

}  // namespace

Device device_of(RigScanner scanner, const std::string& uri) {
  return {&rig_driver(), new dubsar_device{std::make_unique<RigScanner>(std::move(scanner))}, uri};
}

Result<RigParts> open_rig_parts(const std::filesystem::path& file, const DriverRegistry& registry) {
  const Result<std::string> text = read_whole_file(file);
  const Result<RigFile> rig = text ? parse_rig_file(*text, file.string()) : std::unexpected(text.error());
  if (!rig) {
    return std::unexpected(rig.error());
  }
  Result<Device> camera = part(rig->camera, registry, false);
  if (!camera) {
    return std::unexpected(camera.error());
  }
  Result<Device> stage = part(rig->stage, registry, false);
  if (!stage) {
    return std::unexpected(stage.error());
  }
  Status put = rig->region ? put_whole_picture(*camera, file.string()) : Status{};
  put = put ? put_camera_settings(*rig, *camera, file.string()) : put;
  if (!put) {
    return std::unexpected(put.error());
  }
  return RigParts{*rig, std::move(*camera), std::move(*stage)};
}

Result<Device> open_rig(const std::filesystem::path& file, const DriverRegistry& registry) {
  const Result<std::string> text = read_whole_file(file);
  if (!text) {
    return std::unexpected(text.error());
  }
  const Result<RigFile> rig = parse_rig_file(*text, file.string());
  if (!rig) {
    return std::unexpected(rig.error());
  }
  const bool of_range = rig->calibration.empty();
  if (Status said = of_range ? RangeRig::check(*rig, file.string()) : Status{}; !said) {
    return std::unexpected(said.error());
  }
  Result<RigCalibration> calibration = RigCalibration{};
  if (!of_range) {
    const std::filesystem::path beside = file.parent_path() / rig->calibration;
    if (std::error_code ignored; !std::filesystem::exists(beside, ignored)) {
      return bad_input(beside.string(), "the rig has no calibration yet",
                       "make it: dubsar calibrate PICTURES --board BOARD --rig " + file.string());
    }
    const Result<std::string> bytes = read_whole_file(beside);
    calibration = bytes ? parse_calibration(*bytes, beside.string()) : std::unexpected(bytes.error());
    if (!calibration) {
      return std::unexpected(calibration.error());
    }
  }
  Result<Device> camera = part(rig->camera, registry, of_range);
  if (!camera) {
    return std::unexpected(camera.error());
  }
  Result<Device> stage = part(rig->stage, registry, false);
  if (!stage) {
    return std::unexpected(stage.error());
  }
  if (of_range) {
    Result<RangeRig> moved = RangeRig::make(*rig, std::move(*camera), std::move(*stage), file.string());
    return moved ? Result<Device>(Device(&rig_driver(),
                                         new dubsar_device{std::make_unique<RangeRig>(std::move(*moved))},
                                         "rig:" + file.string()))
                 : std::unexpected(moved.error());
  }
  Result<RigScanner> scanner =
      RigScanner::make(*rig, *calibration, std::move(*camera), std::move(*stage), file.string());
  if (!scanner) {
    return std::unexpected(scanner.error());
  }
  return device_of(std::move(*scanner), "rig:" + file.string());
}

std::optional<CalibrationCheck> last_verification(const std::filesystem::path& rig_file) {
  const Result<RigLog> log = rig_log_of(rig_file);
  const std::optional<VerificationEntry> last = log ? log->last() : std::nullopt;
  if (!last || !last->passed) {
    return std::nullopt;
  }
  return CalibrationCheck{last->when, last->artefact, last->error_mm};
}

std::optional<std::string> verification_reminder(const std::string& device_uri) {
  const std::optional<std::filesystem::path> file = rig_file_of(device_uri);
  if (!file) {
    return std::nullopt;
  }
  const std::string mend = "; measure the artefact first: dubsar calibrate --verify";
  const Result<RigLog> log = rig_log_of(*file);
  const std::optional<VerificationEntry> last = log ? log->last() : std::nullopt;
  if (last && !last->passed) {
    return "the rig FAILED its last verification (" + last->when +
           (last->failed.empty() ? std::string() : "; " + last->failed.front()) +
           "): do not scan tablets with it; see to it, then dubsar calibrate --verify";
  }
  if (!last) {
    return "the rig as it stands has not been verified yet" + mend;
  }
  const std::optional<double> age = days_since(last->when);
  if (age && *age <= 1) {
    return std::nullopt;
  }
  const std::string days = age ? number_text(std::floor(*age)) : std::string();
  return "the rig was last verified " +
         (days.empty() ? "nobody knows when" : days + (days == "1" ? " day ago" : " days ago")) + mend;
}

}  // namespace dubsar
