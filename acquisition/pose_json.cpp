// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/pose_json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/json_node.h"

namespace dubsar::session {

namespace {

using nlohmann::json;

constexpr int kTwist = 6;

/// JSON has no word for what is not finite; null stands for "not known".
json finite_or_null(double value) {
  return std::isfinite(value) ? json(value) : json();
}

double number_of(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

std::string text_of(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// All numbers of an array of the right length, or nothing.
std::vector<double> numbers_of(const json& object, const char* key, std::size_t count) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != count ||
      !std::ranges::all_of(*found, [](const json& one) { return one.is_number(); })) {
    return {};
  }
  return found->get<std::vector<double>>();
}

}  // namespace

std::string json_from_pose(const ScanPose& pose) {
  json out;
  out["file"] = pose.file;
  out["model_from_scanner"] = pose.model_from_scanner.row_major();
  out["status"] = to_string(pose.status);
  out["rms_mm"] = finite_or_null(pose.rms_mm);
  out["sigma_mm"] = finite_or_null(pose.sigma_mm);
  out["overlap"] = finite_or_null(pose.overlap);
  out["reason"] = pose.reason;
  if (!pose.warning.empty()) {
    out["warning"] = pose.warning;
  }
  out["locked"] = pose.locked;
  if (pose.group_apart >= 0) {
    out["group_apart"] = pose.group_apart;
  }
  if (pose.covariance) {
    std::vector<double> values;
    for (int row = 0; row < kTwist; ++row) {
      for (int col = 0; col < kTwist; ++col) {
        values.push_back((*pose.covariance)(row, col));
      }
    }
    out["covariance"] = values;
  }
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

Result<ScanPose> pose_from_json(int id, std::string_view text) {
  const auto damaged = [id] {
    return bad_input("pose of scan " + std::to_string(id), "not a stored pose", "register the scan anew");
  };
  const json in = json_depth(text) <= kMaxJsonDepth ? json::parse(text, nullptr, false) : json();
  if (!in.is_object()) {
    return damaged();
  }
  ScanPose pose;
  pose.id = id;
  pose.file = text_of(in, "file");
  pose.reason = text_of(in, "reason");
  pose.warning = text_of(in, "warning");
  pose.rms_mm = number_of(in, "rms_mm");
  pose.sigma_mm = number_of(in, "sigma_mm");
  pose.overlap = number_of(in, "overlap");
  pose.locked = in.value("locked", json(false)) == json(true);
  if (const auto group = in.find("group_apart"); group != in.end() && group->is_number_integer()) {
    pose.group_apart = group->get<int>();
  }
  const std::string status = text_of(in, "status");
  const PoseStatus all[] = {PoseStatus::kRegistered, PoseStatus::kUnsure, PoseStatus::kFailed};
  const auto* known = std::ranges::find_if(all, [&](PoseStatus one) { return status == to_string(one); });
  const std::vector<double> matrix = numbers_of(in, "model_from_scanner", 16);
  if (known == std::end(all) || (matrix.empty() && *known != PoseStatus::kFailed)) {
    return damaged();
  }
  pose.status = *known;
  if (!matrix.empty()) {
    std::array<double, 16> values{};
    std::ranges::copy(matrix, values.begin());
    pose.model_from_scanner = RigidTransform::from_row_major(values);
  }
  if (const std::vector<double> values = numbers_of(in, "covariance", kTwist * kTwist); !values.empty()) {
    pose.covariance.emplace();
    for (int i = 0; i < kTwist * kTwist; ++i) {
      (*pose.covariance)(i / kTwist, i % kTwist) = values[static_cast<std::size_t>(i)];
    }
  }
  return pose;
}

}  // namespace dubsar::session
