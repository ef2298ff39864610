// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_scan_info.h"

#include <Eigen/Core>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/number_text.h"
#include "core/utf8.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

std::unexpected<Error> info_error(const std::string& where, const char* key, const char* wanted) {
  return bad_input(where, std::string("obj_info ") + key + " is not " + wanted,
                   "mend or remove that header line");
}

Status read_vector(const PlyHeader& header, const std::string& where, const char* key,
                   std::optional<Eigen::Vector3d>& into) {
  const std::optional<std::string_view> value = header.info_value(key);
  if (!value) {
    return {};
  }
  std::string_view rest = *value;
  Eigen::Vector3d v;
  for (double& component : v) {
    if (!parse_number(take_word(rest), component) || !std::isfinite(component)) {
      return info_error(where, key, "three numbers");
    }
  }
  into = v;
  return {};
}

Status read_length(const PlyHeader& header, const std::string& where, const char* key, double& into) {
  const std::optional<std::string_view> value = header.info_value(key);
  if (!value) {
    return {};
  }
  std::string_view rest = *value;
  double length = 0;
  if (!parse_number(take_word(rest), length) || !(length >= 0 && length <= 1e6)) {
    return info_error(where, key, "a length");
  }
  into = length;
  return {};
}

std::string vector_line(const char* key, const Eigen::Vector3d& v) {
  return std::string("obj_info ") + key + " " + number_text(v.x()) + " " + number_text(v.y()) + " " +
         number_text(v.z()) + "\n";
}

std::string value_line(const char* key, const std::string& value) {
  return std::string("obj_info ") + key + " " + value + "\n";
}

}  // namespace

Status apply_scan_info(const PlyHeader& header, const std::string& where, RangeGrid& grid) {
  std::optional<Eigen::Vector3d> direction;
  std::optional<Eigen::Vector3d> motion;
  for (const auto& [key, into] :
       {std::pair{ply_info::kDirection, &direction}, std::pair{ply_info::kLaser, &grid.view.laser_mm},
        std::pair{ply_info::kCamera, &grid.view.camera_mm}, std::pair{ply_info::kMotion, &motion}}) {
    if (Status read = read_vector(header, where, key, *into); !read) {
      return read;
    }
  }
  if (direction) {
    const double length = direction->norm();
    if (!(length > 1e-9 && length < 1e9)) {
      return info_error(where, ply_info::kDirection, "a direction");
    }
    // A unit vector is kept to the bit.
    grid.view.direction = std::abs(length - 1.0) < 1e-12 ? *direction : Eigen::Vector3d(*direction / length);
  }
  if (motion) {
    grid.view.motion_per_row_mm = *motion;
  }
  if (Status read = read_length(header, where, ply_info::kSpacing, grid.spacing_mm); !read) {
    return read;
  }
  if (Status read = read_length(header, where, ply_info::kPinTip, grid.pin_tip_diameter_mm); !read) {
    return read;
  }
  if (const auto value = header.info_value(ply_info::kTimestamp)) {
    std::string_view rest = *value;
    if (!parse_integer(take_word(rest), grid.timestamp_ns)) {
      return info_error(where, ply_info::kTimestamp, "a whole number");
    }
  }
  if (const auto value = header.info_value(ply_info::kDevice)) {
    grid.device = *value;
  }
  if (const auto value = header.info_value(ply_info::kSource); value && !value->empty()) {
    grid.source = *value;
  }
  return {};
}

std::string scan_info_lines(const RangeGrid& grid, bool with_source) {
  std::string text = value_line(ply_info::kUnit, "mm") +
                     value_line(ply_info::kCols, std::to_string(grid.cols)) +
                     value_line(ply_info::kRows, std::to_string(grid.rows)) +
                     value_line(ply_info::kSpacing, number_text(grid.spacing_mm)) +
                     vector_line(ply_info::kDirection, grid.view.direction);
  if (grid.view.laser_mm) {
    text += vector_line(ply_info::kLaser, *grid.view.laser_mm);
  }
  if (grid.view.camera_mm) {
    text += vector_line(ply_info::kCamera, *grid.view.camera_mm);
  }
  if (!grid.view.motion_per_row_mm.isZero(0)) {
    text += vector_line(ply_info::kMotion, grid.view.motion_per_row_mm);
  }
  if (grid.pin_tip_diameter_mm > 0) {
    text += value_line(ply_info::kPinTip, number_text(grid.pin_tip_diameter_mm));
  }
  if (grid.timestamp_ns != 0) {
    text += value_line(ply_info::kTimestamp, std::to_string(grid.timestamp_ns));
  }
  if (!grid.device.empty()) {
    text += value_line(ply_info::kDevice, one_line(grid.device));
  }
  if (with_source && !grid.source.empty()) {
    text += value_line(ply_info::kSource, one_line(grid.source));
  }
  return text;
}

}  // namespace dubsar
