// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig.h"
#include "drivers/driver.h"

/// Helpers for drivers that are written in C++ beside Dubsar. Header only, so that a plugin links nothing for
/// them; a driver can do without and include driver.h alone.
namespace dubsar::plugin {

/// A driver of this version that offers nothing yet; set what yours has.
constexpr dubsar_driver empty_driver() {
  dubsar_driver out{};
  out.abi_version = DUBSAR_DRIVER_ABI_VERSION;
  out.struct_size = sizeof out;
  return out;
}

/// Copies text into a field of fixed size, cut to fit, NUL-terminated.
template <std::size_t N>
void copy_text(char (&to)[N], std::string_view from) {
  const std::size_t length = std::min(from.size(), N - 1);
  std::copy_n(from.data(), length, to);
  to[length] = '\0';
}

/// Copies a filled struct to one that the other side lent, as far as that one reaches; its struct_size stays.
template <class T>
void lend(T* to, T from) {
  if (to == nullptr || to->struct_size < sizeof from.struct_size) {
    return;
  }
  from.struct_size = to->struct_size;
  std::memcpy(static_cast<void*>(to), &from, std::min<std::size_t>(to->struct_size, sizeof from));
}

inline std::int32_t report(dubsar_error* error, dubsar_code code, std::string_view what,
                           std::string_view where = {}, std::string_view mend = {}) {
  dubsar_error filled{};
  filled.code = code;
  copy_text(filled.what, what);
  copy_text(filled.where, where);
  copy_text(filled.mend, mend);
  lend(error, filled);
  return code;
}

/// Says it to whoever takes the scan; false where they take no remarks.
inline bool remark(const dubsar_sink& sink, const std::string& text) {
  constexpr std::size_t kEnd = offsetof(dubsar_sink, remark) + sizeof(dubsar_sink::remark);
  if (sink.struct_size < kEnd || sink.remark == nullptr) {
    return false;
  }
  sink.remark(sink.user, text.c_str());
  return true;
}

inline dubsar_code code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return DUBSAR_USAGE;
    case ErrorKind::kBadInput:
      return DUBSAR_BAD_INPUT;
    case ErrorKind::kDevice:
      return DUBSAR_DEVICE;
    case ErrorKind::kStorage:
      return DUBSAR_STORAGE;
    case ErrorKind::kCancelled:
      return DUBSAR_CANCELLED;
    case ErrorKind::kInternal:
      break;
  }
  return DUBSAR_INTERNAL;
}

inline std::int32_t report(dubsar_error* error, const Error& what) {
  return report(error, code_of(what.kind), what.what, what.where, what.mend);
}

/// What a function of the interface returns for that.
inline std::int32_t answer(const Status& status, dubsar_error* error) {
  return status ? std::int32_t{DUBSAR_OK} : report(error, status.error());
}

/// Runs a function of the interface; an exception ends here, as an error.
template <class Body>
std::int32_t fenced(dubsar_error* error, const Body& body) noexcept {
  try {
    return body();
  } catch (const std::exception& e) {
    return report(error, DUBSAR_INTERNAL, e.what());
  } catch (...) {
    return report(error, DUBSAR_INTERNAL, "the driver threw something unknown");
  }
}

/// One row of a driver's table of options or settings.
struct SettingRow {
  dubsar_type type;
  const char* key;
  const char* help;
  const char* unit = nullptr;
  const char* choices = nullptr;
  double minimum = 1;  ///< no range when minimum > maximum
  double maximum = 0;
  std::uint32_t flags = DUBSAR_SETTING_READABLE | DUBSAR_SETTING_WRITABLE;
};

template <class Rows>
std::int32_t describe(const Rows& rows, dubsar_setting_callback callback, void* user) {
  for (const SettingRow& row : rows) {
    const dubsar_setting setting{sizeof(dubsar_setting),
                                 row.type,
                                 row.flags,
                                 row.key,
                                 row.help,
                                 row.unit,
                                 row.choices,
                                 row.minimum,
                                 row.maximum,
                                 0.0};
    if (callback(user, &setting) != 0) {
      return DUBSAR_CANCELLED;
    }
  }
  return DUBSAR_OK;
}

/// Refuses the value of an option: says what the option takes.
inline std::unexpected<Error> not_understood(const SettingRow& row, std::string_view value) {
  std::ostringstream takes;
  takes << row.key << " takes " << row.help;
  if (row.minimum <= row.maximum) {
    takes << std::setprecision(12) << "; from " << row.minimum << " to " << row.maximum;
  }
  if (row.unit != nullptr) {
    takes << ", " << row.unit;
  }
  const std::string said = std::string(row.key) + "=" + std::string(value);
  return fail(ErrorKind::kUsage, said + " is not understood", {}, takes.str());
}

/// A whole text as a finite number.
inline std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !(value - value == 0)) {
    return std::nullopt;
  }
  return value;
}

inline dubsar_view view_of(const ScannerView& view) {
  dubsar_view out{};
  out.struct_size = sizeof out;
  std::copy_n(view.direction.data(), 3, out.direction);
  std::copy_n(view.motion_per_row_mm.data(), 3, out.motion_per_row_mm);
  if (view.laser_mm) {
    out.flags |= DUBSAR_VIEW_LASER;
    std::copy_n(view.laser_mm->data(), 3, out.laser_mm);
  }
  if (view.camera_mm) {
    out.flags |= DUBSAR_VIEW_CAMERA;
    std::copy_n(view.camera_mm->data(), 3, out.camera_mm);
  }
  return out;
}

/// The geometry of a rig; flags and scan_count are left to the driver.
inline dubsar_capabilities capabilities_of(const Rig& rig) {
  dubsar_capabilities out{};
  out.struct_size = sizeof out;
  out.flags = DUBSAR_HAS_RIG | (rig.has_turntable ? DUBSAR_HAS_TURNTABLE : 0U) |
              (rig.tilt_max_rad > rig.tilt_min_rad ? DUBSAR_HAS_TILT : 0U) |
              (rig.hand_turns ? DUBSAR_HAS_HAND_TURNS : 0U) | (rig.robot ? DUBSAR_HAS_ARM : 0U) |
              (rig.head ? DUBSAR_HAS_HEAD : 0U) |
              (rig.has_turntable && !rig.turns_fully() ? DUBSAR_HAS_TURN_LIMITS : 0U);
  out.scan_count = -1;
  out.tilt_min_rad = rig.tilt_min_rad;
  out.tilt_max_rad = rig.tilt_max_rad;
  out.spacing_mm = rig.spacing_mm;
  out.field_x_mm = rig.field_x_mm;
  out.field_y_mm = rig.field_y_mm;
  out.depth_range_mm = rig.depth_range_mm;
  out.support_height_mm = rig.support_height_mm;
  out.calibration_age_days = rig.calibration_age_days.value_or(-1.0);
  out.view = view_of(rig.view);
  copy_text(out.name, rig.name);
  copy_text(out.calibration, rig.calibration);
  out.turntable_min_rad = rig.turntable_rad.low;
  out.turntable_max_rad = rig.turntable_rad.high;
  if (rig.head) {
    std::copy_n(rig.head->low_mm.data(), 3, out.head_low_mm);
    std::copy_n(rig.head->high_mm.data(), 3, out.head_high_mm);
  }
  if (rig.robot) {
    const auto put = [](const Range& range, double(&to)[2]) {
      to[0] = range.low;
      to[1] = range.high;
    };
    std::copy_n(rig.robot->base_mm.data(), 3, out.arm_base_mm);
    put(rig.robot->reach_mm, out.arm_reach_mm);
    put(rig.robot->height_mm, out.arm_height_mm);
    put(rig.robot->standoff_mm, out.arm_standoff_mm);
  }
  return out;
}

/// A placement as it came; a program of before arms sends a shorter one, whose end reads as zero.
inline Placement placement_from(const dubsar_placement* sent) {
  dubsar_placement from{};
  std::memcpy(static_cast<void*>(&from), sent, std::min<std::size_t>(sent->struct_size, sizeof from));
  Placement out;
  out.turntable_rad = from.turntable_rad;
  out.tilt_rad = from.tilt_rad;
  const auto pose = [](const double(&numbers)[16]) {
    std::array<double, 16> rows{};
    std::copy_n(numbers, 16, rows.begin());
    return RigidTransform::from_row_major(rows);
  };
  if (from.has_hand_turn != 0) {
    out.hand_turn = pose(from.hand_turn);
  }
  if (from.has_free_pose != 0) {
    out.free_pose = pose(from.stage_from_scanner);
  }
  return out;
}

/// What begin() tells about a grid; device_id and source point into the grid.
inline dubsar_scan_info scan_info_of(const RangeGrid& grid) {
  dubsar_scan_info out{};
  out.struct_size = sizeof out;
  out.cols = grid.cols;
  out.expected_rows = grid.rows;
  out.spacing_mm = grid.spacing_mm;
  out.view = view_of(grid.view);
  if (grid.nominal) {
    out.flags |= DUBSAR_SCAN_NOMINAL;
    const std::array<double, 16> pose = grid.nominal->tablet_from_scanner.row_major();
    std::copy(pose.begin(), pose.end(), out.tablet_from_scanner);
    out.placement = grid.nominal->placement;
    out.sigma_mm = grid.nominal->sigma_mm;
    out.sigma_rad = grid.nominal->sigma_rad;
    out.hand_sigma_mm = grid.nominal->hand_sigma_mm;
    out.hand_sigma_rad = grid.nominal->hand_sigma_rad;
  }
  out.pin_tip_diameter_mm = grid.pin_tip_diameter_mm;
  out.timestamp_ns = grid.timestamp_ns;
  out.device_id = grid.device.c_str();
  out.source = grid.source.c_str();
  return out;
}

/// One row of a grid as a profile that points into it.
inline dubsar_profile profile_of(const RangeGrid& grid, int row) {
  const std::size_t at = grid.index(row, 0);
  dubsar_profile out{};
  out.struct_size = sizeof out;
  out.count = static_cast<std::uint32_t>(grid.cols);
  out.row = row;
  out.x = grid.x.data() + at;
  out.y = grid.y.data() + at;
  out.z = grid.z.data() + at;
  out.valid = grid.valid.data() + at;
  out.intensity = grid.intensity.empty() ? nullptr : grid.intensity.data() + at;
  out.confidence = grid.confidence.empty() ? nullptr : grid.confidence.data() + at;
  out.rgb = grid.rgb.empty() ? nullptr : grid.rgb.data() + 3 * at;
  return out;
}

}  // namespace dubsar::plugin
