// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/abi.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "core/rig_limits.h"
#include "core/rigid_matrix.h"

namespace dubsar::abi {

namespace {

/// More than any scanner has, and small enough that rows x cols of a few rows cannot exhaust the memory.
constexpr std::int32_t kMaxCols = 1 << 20;
constexpr std::uint32_t kMaxChunk = 1U << 26U;

ErrorKind kind_of(std::int32_t code) {
  switch (code) {
    case DUBSAR_USAGE:
      return ErrorKind::kUsage;
    case DUBSAR_BAD_INPUT:
      return ErrorKind::kBadInput;
    case DUBSAR_STORAGE:
      return ErrorKind::kStorage;
    case DUBSAR_CANCELLED:
      return ErrorKind::kCancelled;
    default:
      return ErrorKind::kDevice;
  }
}

/// A name that a driver gives a scan, of a size that it alone knows: on every page stand its first bytes, as
/// many as a path has.
std::string name_from(const char* text) {
  constexpr std::size_t kMostBytes = 4096;
  return text == nullptr ? std::string() : std::string(text, ::strnlen(text, kMostBytes));
}

Eigen::Vector3d vector_from(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

/// 0 for anything that is no length at all.
double positive_or_zero(double value) {
  return std::isfinite(value) && value > 0 ? value : 0.0;
}

Result<Range> range_from(double low, double high, const char* of, const std::string& where,
                         double most = std::numeric_limits<double>::max()) {
  if (!(std::abs(low) <= most && std::abs(high) <= most && low <= high)) {
    return std::unexpected(faulty(where, std::string("told a range of ") + of + " that is none"));
  }
  return Range{low, high};
}

/// A session that keeps the rig would not be read again.
Status within_reason(const Rig& rig, const std::string& where) {
  const auto beyond = [&](const char* what, double value, double most, const char* unit) -> Status {
    std::ostringstream words;
    words.precision(9);
    words << "told a rig " << what << value << " " << unit << ", beyond " << most << " " << unit;
    return std::unexpected(faulty(where, words.str()));
  };
  if (rig.spacing_mm > kMostRigSpacingMm) {
    return beyond("with a spacing of ", rig.spacing_mm, kMostRigSpacingMm, "mm");
  }
  if (rig.depth_range_mm > kMostDepthRangeMm) {
    return beyond("with a depth range of ", rig.depth_range_mm, kMostDepthRangeMm, "mm");
  }
  if (std::abs(rig.support_height_mm) > kMostSupportHeightMm) {
    return beyond("with a support height of ", rig.support_height_mm, kMostSupportHeightMm, "mm");
  }
  if (rig.calibration_age_days.value_or(0) > kMostCalibrationAgeDays) {
    return beyond("whose calibration has an age of ", *rig.calibration_age_days, kMostCalibrationAgeDays,
                  "days");
  }
  return {};
}

/// Head, turntable and arm.
Status reach_from(const dubsar_capabilities& from, Rig& rig, const std::string& where) {
  Status status;
  const auto take = [&](Range& to, double low, double high, const char* of,
                        double most = std::numeric_limits<double>::max()) {
    const Result<Range> range = range_from(low, high, of, where, most);
    if (range) {
      to = *range;
    } else if (status) {
      status = std::unexpected(range.error());
    }
  };
  if ((from.flags & DUBSAR_HAS_TURN_LIMITS) != 0) {
    take(rig.turntable_rad, from.turntable_min_rad, from.turntable_max_rad, "its turntable", kMostTurnRad);
  }
  if ((from.flags & DUBSAR_HAS_HEAD) != 0) {
    const HeadBox head{vector_from(from.head_low_mm), vector_from(from.head_high_mm)};
    if (!head.low_mm.allFinite() || !head.high_mm.allFinite() ||
        (head.low_mm.array() > head.high_mm.array()).any()) {
      return std::unexpected(faulty(where, "told a head that is no box"));
    }
    rig.head = head;
  }
  if ((from.flags & DUBSAR_HAS_ARM) != 0) {
    RobotReach arm;
    arm.base_mm = vector_from(from.arm_base_mm);
    if (!arm.base_mm.allFinite()) {
      return std::unexpected(faulty(where, "told an arm that stands nowhere"));
    }
    take(arm.reach_mm, from.arm_reach_mm[0], from.arm_reach_mm[1], "its arm's reach");
    take(arm.height_mm, from.arm_height_mm[0], from.arm_height_mm[1], "its head's height");
    take(arm.standoff_mm, from.arm_standoff_mm[0], from.arm_standoff_mm[1], "its head's stand-off");
    rig.robot = arm;
  }
  return status;
}

}  // namespace

Error error_from(std::int32_t code, const dubsar_error& error, const std::string& where) {
  Error out{kind_of(code), text(error.what), text(error.where), text(error.mend)};
  if (out.what.empty()) {
    out.what = code == DUBSAR_CANCELLED ? "cancelled" : "the driver failed and did not say why";
  }
  if (out.where.empty()) {
    out.where = where;
  }
  return out;
}

Error faulty(const std::string& where, const std::string& what) {
  return {ErrorKind::kDevice, "the driver " + what, where,
          "update the driver or report the fault to its makers"};
}

SettingInfo setting_from(const dubsar_setting& setting) {
  SettingInfo out;
  out.key = text(setting.key);
  out.help = text(setting.help);
  out.unit = text(setting.unit);
  out.type = setting.type >= DUBSAR_TYPE_BOOL && setting.type <= DUBSAR_TYPE_CHOICE
                 ? static_cast<SettingType>(setting.type)
                 : SettingType::kText;
  std::istringstream choices(text(setting.choices));
  for (std::string choice; std::getline(choices, choice, '|');) {
    out.choices.push_back(choice);
  }
  if (setting.minimum <= setting.maximum) {
    out.range = {setting.minimum, setting.maximum};
  }
  out.step = setting.step;
  out.readable = (setting.flags & DUBSAR_SETTING_READABLE) != 0;
  out.writable = (setting.flags & DUBSAR_SETTING_WRITABLE) != 0;
  return out;
}

ScannerView view_from(const dubsar_view& view) {
  ScannerView out;
  const Eigen::Vector3d direction = vector_from(view.direction);
  if (direction.allFinite() && direction.norm() > 0.5) {
    out.direction = direction.normalized();
  }
  const auto position = [&](std::uint32_t flag, const double(&at)[3]) -> std::optional<Eigen::Vector3d> {
    const Eigen::Vector3d p = vector_from(at);
    return (view.flags & flag) != 0 && p.allFinite() ? std::optional(p) : std::nullopt;
  };
  out.laser_mm = position(DUBSAR_VIEW_LASER, view.laser_mm);
  out.camera_mm = position(DUBSAR_VIEW_CAMERA, view.camera_mm);
  if (const Eigen::Vector3d motion = vector_from(view.motion_per_row_mm); motion.allFinite()) {
    out.motion_per_row_mm = motion;
  }
  return out;
}

Result<DeviceCapabilities> capabilities_from(const dubsar_capabilities& from, const std::string& where) {
  DeviceCapabilities out;
  out.finite = (from.flags & DUBSAR_IS_FINITE) != 0;
  out.yields_scans = (from.flags & DUBSAR_YIELDS_NO_SCANS) == 0;
  out.yields_frames = (from.flags & DUBSAR_YIELDS_FRAMES) != 0;
  out.is_stage = (from.flags & DUBSAR_IS_STAGE) != 0;
  out.serial = text(from.serial);
  out.model = text(from.model);
  if (out.finite && from.scan_count >= 0) {
    out.scan_count = from.scan_count;
  }
  if ((from.flags & DUBSAR_HAS_RIG) == 0) {
    return out;
  }
  Rig rig;
  rig.name = text(from.name);
  rig.view = view_from(from.view);
  rig.spacing_mm = positive_or_zero(from.spacing_mm);
  rig.field_x_mm = positive_or_zero(from.field_x_mm);
  rig.field_y_mm = positive_or_zero(from.field_y_mm);
  rig.depth_range_mm = positive_or_zero(from.depth_range_mm);
  if (rig.spacing_mm == 0 || rig.field_x_mm == 0 || rig.field_y_mm == 0 || rig.depth_range_mm == 0) {
    return std::unexpected(faulty(where, "told a rig without spacing, field or depth range"));
  }
  rig.has_turntable = (from.flags & DUBSAR_HAS_TURNTABLE) != 0;
  if ((from.flags & (DUBSAR_HAS_TILT | DUBSAR_HAS_ARM)) != 0) {
    const Result<Range> tilt =
        range_from(from.tilt_min_rad, from.tilt_max_rad, "its tilt", where, kMostTurnRad);
    if (!tilt) {
      return std::unexpected(tilt.error());
    }
    rig.tilt_min_rad = tilt->low;
    rig.tilt_max_rad = tilt->high;
  }
  rig.hand_turns = (from.flags & DUBSAR_HAS_HAND_TURNS) != 0;
  rig.support_height_mm = std::isfinite(from.support_height_mm) ? from.support_height_mm : 0.0;
  rig.calibration = text(from.calibration);
  if (std::isfinite(from.calibration_age_days) && from.calibration_age_days >= 0) {
    rig.calibration_age_days = from.calibration_age_days;
  }
  if (const Status sane = within_reason(rig, where); !sane) {
    return std::unexpected(sane.error());
  }
  if (const Status moves = reach_from(from, rig, where); !moves) {
    return std::unexpected(moves.error());
  }
  out.rig = std::move(rig);
  return out;
}

Result<ScanInfo> scan_info_from(const dubsar_scan_info& from, const std::string& where) {
  ScanInfo out;
  out.organised = (from.flags & DUBSAR_SCAN_UNORDERED) == 0;
  if (out.organised && (from.cols <= 0 || from.cols > kMaxCols)) {
    return std::unexpected(faulty(where, "announced profiles of " + std::to_string(from.cols) + " samples"));
  }
  out.cols = out.organised ? from.cols : 0;
  out.expected_rows = std::max(0, from.expected_rows);
  out.spacing_mm = positive_or_zero(from.spacing_mm);
  out.view = view_from(from.view);
  if ((from.flags & DUBSAR_SCAN_NOMINAL) != 0) {
    NominalPose nominal;
    const std::optional<RigidTransform> pose = rigid_from_row_major(from.tablet_from_scanner);
    if (!pose) {
      return std::unexpected(
          faulty(where,
                 "told a nominal pose that is no rigid motion, written row by row with the "
                 "last row 0 0 0 1"));
    }
    nominal.tablet_from_scanner = *pose;
    nominal.placement = from.placement;
    nominal.sigma_mm = positive_or_zero(from.sigma_mm);
    nominal.sigma_rad = positive_or_zero(from.sigma_rad);
    nominal.hand_sigma_mm = positive_or_zero(from.hand_sigma_mm);
    nominal.hand_sigma_rad = positive_or_zero(from.hand_sigma_rad);
    out.nominal = nominal;
  }
  out.pin_tip_diameter_mm = positive_or_zero(from.pin_tip_diameter_mm);
  out.timestamp_ns = from.timestamp_ns;
  out.device = name_from(from.device_id);
  out.source = name_from(from.source);
  out.file = name_from(from.file);
  return out;
}

Result<Profile> profile_from(const dubsar_profile& from, const std::string& where) {
  const std::size_t n = from.count;
  if (from.count > kMaxChunk || (n > 0 && (from.x == nullptr || from.y == nullptr || from.z == nullptr))) {
    return std::unexpected(faulty(where, "sent a profile without samples"));
  }
  Profile out;
  out.row = from.row;
  const auto span = [](const auto* data, std::size_t count) {
    return data == nullptr ? std::span<std::remove_pointer_t<decltype(data)>>{} : std::span(data, count);
  };
  out.x = span(from.x, n);
  out.y = span(from.y, n);
  out.z = span(from.z, n);
  out.valid = span(from.valid, n);
  out.intensity = span(from.intensity, n);
  out.confidence = span(from.confidence, n);
  out.rgb = span(from.rgb, 3 * n);
  out.normals = span(from.normals, 3 * n);
  out.timestamp_ns = from.timestamp_ns;
  if ((from.flags & DUBSAR_PROFILE_ENCODER) != 0) {
    out.encoder = from.encoder;
  }
  return out;
}

}  // namespace dubsar::abi
