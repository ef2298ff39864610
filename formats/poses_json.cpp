// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/poses_json.h"

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

using Covariance = Eigen::Matrix<double, 6, 6>;

OrderedJson covariance_json(const Covariance& covariance) {
  OrderedJson numbers = OrderedJson::array();
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) {
      numbers.push_back(covariance(r, c));
    }
  }
  return numbers;
}

Covariance covariance_from(const JsonNode& node) {
  const std::vector<double> values = node.numbers(36);
  Covariance covariance;
  for (int i = 0; i < 36; ++i) {
    covariance(i / 6, i % 6) = values[static_cast<std::size_t>(i)];
  }
  return covariance;
}

ScanPose pose_from(const JsonNode& node, double mm) {
  ScanPose pose;
  pose.id = -1;
  const auto id = node.find("id");
  const auto file = node.find("file");
  if (!id && !file) {
    node.complain("has neither id nor file");
  }
  if (id) {
    pose.id = static_cast<int>(id->integer(0, std::numeric_limits<int>::max()));
  }
  if (file) {
    pose.file = file->text();
  }
  if (const auto packed = node.find("packed_as")) {
    for (const JsonNode& one : packed->items()) {
      pose.packed_as.push_back(one.text());
    }
  }
  pose.status = PoseStatus::kRegistered;
  if (const auto status = node.find("status")) {
    constexpr PoseStatus kStatus[] = {PoseStatus::kRegistered, PoseStatus::kUnsure, PoseStatus::kFailed};
    pose.status = kStatus[status->one_of({"registered", "unsure", "failed"})];
  }
  pose.model_from_scanner = node.at("model_from_scanner").transform(mm);
  const auto optional_number = [&](const char* key, double scale, double& into) {
    if (const auto value = node.find(key)) {
      into = scale * value->number(0);
    }
  };
  optional_number("rms_mm", 1, pose.rms_mm);
  optional_number("sigma_mm", 1, pose.sigma_mm);
  optional_number("overlap", 1, pose.overlap);
  if (const auto reason = node.find("reason")) {
    pose.reason = reason->text();
  }
  if (const auto warning = node.find("warning")) {
    pose.warning = warning->text();
  }
  if (const auto locked = node.find("locked")) {
    pose.locked = locked->boolean();
  }
  if (const auto group = node.find("group_apart")) {
    pose.group_apart = static_cast<int>(group->integer(0, std::numeric_limits<int>::max()));
  }
  if (const auto covariance = node.find("covariance")) {
    pose.covariance = covariance_from(*covariance);
  }
  return pose;
}

}  // namespace

std::string poses_to_json(std::span<const ScanPose> poses) {
  OrderedJson scans = OrderedJson::array();
  for (const ScanPose& pose : poses) {
    OrderedJson scan;
    if (pose.id >= 0) {
      scan["id"] = pose.id;
    }
    scan["file"] = pose.file;
    if (!pose.packed_as.empty()) {
      scan["packed_as"] = pose.packed_as;
    }
    // A failed pose may hold anything; the file keeps its shape.
    scan["model_from_scanner"] =
        json_of(pose.model_from_scanner.is_rigid() ? pose.model_from_scanner : RigidTransform{});
    scan["status"] = to_string(pose.status);
    scan["rms_mm"] = pose.rms_mm;
    scan["sigma_mm"] = pose.sigma_mm;
    scan["overlap"] = pose.overlap;
    scan["reason"] = pose.reason;
    if (!pose.warning.empty()) {
      scan["warning"] = pose.warning;
    }
    scan["locked"] = pose.locked;
    if (pose.group_apart >= 0) {
      scan["group_apart"] = pose.group_apart;
    }
    if (pose.covariance) {
      scan["covariance"] = covariance_json(*pose.covariance);
    }
    scans.push_back(std::move(scan));
  }
  OrderedJson root;
  root["unit"] = "mm";
  root["frame"] = "model";
  root["scans"] = std::move(scans);
  return text_of(root);
}

Status write_poses(const std::filesystem::path& path, std::span<const ScanPose> poses) {
  return write_file_atomically(path, poses_to_json(poses));
}

Result<std::vector<ScanPose>> parse_poses(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const double mm = mm_per_unit_of(root);
  std::vector<ScanPose> poses;
  for (const JsonNode& scan : root.at("scans").items()) {
    poses.push_back(pose_from(scan, mm));
  }
  if (Status status = document->status("give poses as docs/formats/poses.md has them"); !status) {
    return std::unexpected(status.error());
  }
  return poses;
}

Result<std::vector<ScanPose>> read_poses(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_poses(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
