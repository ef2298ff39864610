// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/poses_conf.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "formats/atomic_file.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20U;
/// How far a quaternion's length may be from 1: it was rounded in print.
constexpr double kLengthTolerance = 1e-3;

}  // namespace

Result<std::vector<ScanPose>> parse_conf_poses(std::string_view text, const std::string& where,
                                               double mm_per_unit) {
  text = without_byte_order_mark(text);
  if (has_macintosh_lines(text)) {
    return parse_conf_poses(with_line_feeds(text), where, mm_per_unit);
  }
  std::vector<ScanPose> poses;
  TextScanner scanner(text);
  while (!scanner.at_end()) {
    const std::size_t start = scanner.position();
    std::string_view line = scanner.line();
    const std::string_view word = take_word(line);
    if (word != "bmesh" && word != "mesh") {
      continue;
    }
    const std::string_view file = take_word(line);
    std::array<double, 7> v{};
    bool whole = true;
    for (double& value : v) {
      whole = whole && parse_number(take_word(line), value) && std::isfinite(value);
    }
    const Eigen::Quaterniond scan_from_model(v[6], v[3], v[4], v[5]);
    ScanPose pose;
    pose.id = -1;
    pose.file = file;
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = {scan_from_model.normalized().conjugate().toRotationMatrix(),
                               mm_per_unit * Eigen::Vector3d(v[0], v[1], v[2])};
    if (!whole || !(std::abs(scan_from_model.norm() - 1.0) < kLengthTolerance) ||
        !pose.model_from_scanner.is_rigid()) {
      scanner.seek(start);
      return bad_input(where, fmt::format("line {} is no pose", scanner.line_number()),
                       "write `bmesh FILE tx ty tz qx qy qz qw`, the last four a unit quaternion");
    }
    poses.push_back(std::move(pose));
  }
  if (poses.empty()) {
    return bad_input(where, "no pose in it", "give lines `bmesh FILE tx ty tz qx qy qz qw`");
  }
  return poses;
}

Result<std::vector<ScanPose>> read_conf_poses(const std::filesystem::path& path, double mm_per_unit) {
  const Result<std::string> text = read_whole_file(path, kMostBytes);
  return text ? parse_conf_poses(*text, path.string(), mm_per_unit) : std::unexpected(text.error());
}

}  // namespace dubsar
