// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_log.h"

#include "acquisition/device_uri.h"
#include "acquisition/rig_scan.h"
#include "core/number_text.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/rig_toml.h"

namespace dubsar {

namespace {

std::string vector_text(const Eigen::Vector3d& v) {
  return number_text(v.x()) + " " + number_text(v.y()) + " " + number_text(v.z());
}

/// A rig file has much that may change with the measurement still good, such as where a scan begins.
std::string range_camera_text(const RigFile& rig) {
  const RigMotion motion = rig.motion.value_or(RigMotion{});
  return rig.camera + ", " + motion_word(motion.kind) + ", direction " + vector_text(motion.direction) +
         ", point " + vector_text(motion.axis_point_mm);
}

Result<RigLog> log_of_calibration(const std::filesystem::path& file) {
  const Result<std::string> json = read_whole_file(file);
  const Result<RigCalibration> calibration =
      json ? parse_calibration(*json, file.string()) : std::unexpected(json.error());
  if (!calibration) {
    return std::unexpected(calibration.error());
  }
  return RigLog{file, verification_log_of(file), calibration->made_at, calibration->camera_serial, {}};
}

}  // namespace

std::optional<VerificationEntry> RigLog::last() const {
  const Result<VerificationLog> lines = read_verification_log(log);
  if (!lines || lines->entries.empty() || lines->entries.back().calibration != as_it_stands) {
    return std::nullopt;
  }
  const VerificationEntry* latest = &lines->entries.back();
  if (!days_since(latest->when)) {
    return *latest;
  }
  // Whoever looks for what went wrong measures an earlier scan once more: it says nothing of the rig since.
  for (const VerificationEntry& entry : lines->entries) {
    const bool of_it = entry.calibration == as_it_stands && days_since(entry.when).has_value();
    if (of_it && entry.when > latest->when) {
      latest = &entry;
    }
  }
  return *latest;
}

std::optional<std::filesystem::path> rig_file_of(const std::string& device_uri) {
  const Result<DeviceUri> uri = parse_device_uri(device_uri);
  return uri && uri->scheme == "rig" ? std::optional<std::filesystem::path>(uri->locator) : std::nullopt;
}

Result<RigLog> rig_log_of(const std::filesystem::path& file) {
  if (file.extension() != ".toml") {
    return log_of_calibration(file);
  }
  const Result<std::string> text = read_whole_file(file);
  const Result<RigFile> rig = text ? parse_rig_file(*text, file.string()) : std::unexpected(text.error());
  if (!rig) {
    return std::unexpected(rig.error());
  }
  if (!rig->calibration.empty()) {
    Result<RigLog> log = log_of_calibration(file.parent_path() / rig->calibration);
    if (log) {
      log->rig_name = rig->name;
    }
    return log;
  }
  return RigLog{file, verification_log_of(file), range_camera_text(*rig), {}, rig->name};
}

}  // namespace dubsar
