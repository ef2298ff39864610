// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/range_grid.h"
#include "core/result.h"
#include "core/rig.h"
#include "drivers/frame.h"
#include "drivers/stage.h"

struct dubsar_device;
struct dubsar_driver;

namespace dubsar {

enum class SettingType { kBool, kInteger, kNumber, kText, kChoice };

/// An option of open() or a setting of an open device, with what it takes.
struct SettingInfo {
  std::string key;
  std::string help;
  std::string unit;
  SettingType type = SettingType::kText;
  std::vector<std::string> choices;
  std::optional<std::pair<double, double>> range;
  double step = 0;
  bool readable = true;
  bool writable = true;
};

using SettingValue = std::variant<bool, std::int64_t, double, std::string>;

/// What a setting takes, in words: "a number from 10 to 1000".
[[nodiscard]] std::string taken_by(const SettingInfo& setting);

struct DeviceCapabilities {
  std::optional<Rig> rig;  ///< the device's geometry, where it knows one
  bool can_place = false;  ///< place() does something
  bool finite = false;     ///< plays what was recorded; scan() comes to an end
  std::optional<std::int64_t> scan_count;
  bool yields_scans = true;    ///< scan() makes scans
  bool yields_frames = false;  ///< a camera: start_frames() and what goes with it
  bool is_stage = false;       ///< axes and lasers: axes() and what goes with it
  std::string serial;          ///< of this one device; empty when not known
  std::string model;
};

/// What is known of a scan before its first profile.
struct ScanInfo {
  bool organised = true;
  int cols = 0;           ///< samples per profile; 0 when not organised
  int expected_rows = 0;  ///< 0 when not known
  double spacing_mm = 0;  ///< 0 when not known
  ScannerView view;
  std::optional<NominalPose> nominal;
  double pin_tip_diameter_mm = 0;
  std::int64_t timestamp_ns = 0;
  std::string device;
  std::string source;
  std::string file{};  ///< that a recorded scan is read from, with its folders; empty without one
};

/// One row as it came: spans are as long as x, or empty (rgb and normals: three times as long).
struct Profile {
  std::int64_t row = 0;
  std::span<const float> x, y, z;
  std::span<const std::uint8_t> valid;
  std::span<const float> intensity, confidence;
  std::span<const std::uint8_t> rgb;
  std::span<const float> normals;
  std::int64_t timestamp_ns = 0;
  std::optional<std::int64_t> encoder;  ///< counts of the motion encoder
};

struct ScanTally {
  std::uint64_t profiles_sent = 0;
  std::uint64_t profiles_dropped = 0;
  std::uint64_t frames_repeated = 0;
};

/// Takes a scan profile by profile, on the thread that called Device::scan. Returning false cancels the scan.
class ProfileSink {
 public:
  virtual ~ProfileSink() = default;
  virtual bool begin(const ScanInfo& info) = 0;
  virtual bool profile(const Profile& profile) = 0;
  virtual void end(const ScanTally& tally) = 0;
  /// What the operator should know of the scan and what stops nothing: one line, between begin and end.
  virtual void remark(const std::string& /*text*/) {}
};

enum class ScanOutcome { kScanned, kExhausted };

/// An open device; closes it when it goes, and its last frame with it. Use from one thread at a time. What a
/// driver answers is checked here, so that a faulty one gives an error rather than a crash as far as that can
/// be told.
class Device {
 public:
  /// Takes over an opened device of the driver. For DriverRegistry.
  Device(const dubsar_driver* driver, dubsar_device* device, std::string uri);
  Device(Device&& other) noexcept = default;
  Device& operator=(Device&& other) noexcept = default;

  [[nodiscard]] const std::string& uri() const { return uri_; }
  [[nodiscard]] Result<DeviceCapabilities> capabilities() const;

  [[nodiscard]] Result<std::vector<SettingInfo>> settings() const;
  [[nodiscard]] Result<SettingValue> get(const std::string& key) const;
  /// Checks type, range and choice against settings() first.
  Status set(const std::string& key, const SettingValue& value);

  /// kUsage when the device cannot be placed or the placement lies outside its limits; nothing has moved
  /// then.
  Status place(const Placement& placement);
  /// Stops all motion, where the device offers that; else nothing. From any thread, also while place() or
  /// scan() runs on another: these then return kCancelled soon.
  Status stop() const;
  [[nodiscard]] bool can_stop() const;
  /// Runs the next scan into the sink. A sink that returned false gives kCancelled. On an error the sink has
  /// had its end() when it had a begin().
  Result<ScanOutcome> scan(ProfileSink& sink);

  /// Starts the stream of a camera with a pool of so many buffers (0: as the driver likes). Of a device that
  /// was gone: looks for it again.
  Status start_frames(std::uint32_t pool = 0);
  /// The next frame; nothing when none came in time. kDevice within 2 s when the device is gone.
  [[nodiscard]] Result<std::optional<Frame>> next_frame(std::chrono::milliseconds timeout);
  Status stop_frames();
  [[nodiscard]] Result<FrameCounters> frame_counters() const;
  /// One frame of a camera whose setting `trigger` is `software`.
  Status trigger_frame();

  [[nodiscard]] Result<std::vector<StageAxis>> axes() const;
  Status home();
  /// kUsage before anything moves when the position is outside the soft limits.
  Status move(const StageMove& move);
  [[nodiscard]] Result<StageReading> motion() const;
  /// Power from 0 to 1.
  Status set_laser(std::uint32_t laser, double power);
  /// From any thread: motion ends at once, lasers go off, and nothing moves until home().
  Status emergency_stop() const;

 private:
  const dubsar_driver* driver_;
  std::shared_ptr<dubsar_device> device_;  // shared with the frames that are lent
  std::string uri_;
};

}  // namespace dubsar
