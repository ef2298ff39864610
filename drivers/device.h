// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

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

struct DeviceCapabilities {
  std::optional<Rig> rig;  ///< the device's geometry, where it knows one
  bool can_place = false;  ///< place() does something
  bool finite = false;     ///< plays what was recorded; scan() comes to an end
  std::optional<std::int64_t> scan_count;
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
};

enum class ScanOutcome { kScanned, kExhausted };

/// An open device; closes it when it goes. Use from one thread at a time. What a driver answers is checked
/// here, so that a faulty one gives an error rather than a crash as far as that can be told.
class Device {
 public:
  /// Takes over an opened device of the driver. For DriverRegistry.
  Device(const dubsar_driver* driver, dubsar_device* device, std::string uri);

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

 private:
  struct Closer {
    const dubsar_driver* driver = nullptr;
    void operator()(dubsar_device* device) const;
  };
  const dubsar_driver* driver_;
  std::unique_ptr<dubsar_device, Closer> device_;
  std::string uri_;
};

}  // namespace dubsar
