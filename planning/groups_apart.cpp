// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/groups_apart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/scan_list.h"
#include "core/units.h"
#include "planning/joining_edge.h"
#include "planning/model_faces.h"

namespace dubsar {

namespace {

/// How a hand lays a tablet anyway.
constexpr double kLiesSoDeg = 5;

Eigen::Vector3d towards_scanner(const PlacedScan& scan) {
  return (scan.model_from_scanner.rotation * -scan.grid->view.direction).normalized();
}

/// Of equals the last, which the operator remembers best.
const PlacedScan& nearest_to(std::span<const PlacedScan> scans, const Eigen::Vector3d& direction) {
  const PlacedScan* best = &scans.front();
  for (const PlacedScan& scan : scans) {
    constexpr double kAsNear = 1e-3;
    const double gain = towards_scanner(scan).dot(direction) - towards_scanner(*best).dot(direction);
    if (gain > kAsNear || (gain > -kAsNear && scan.id > best->id)) {
      best = &scan;
    }
  }
  return *best;
}

/// "; to join them …": a scan over the edge from half the side that was seen, one of the edge, and one from
/// half the other side. Each shows half of what the one before it does.
std::string way_over(const JoiningEdge& edge, std::span<const PlacedScan> model) {
  const Eigen::Vector3d first = (edge.outward + edge.seen).normalized();
  const PlacedScan& scan = nearest_to(model, first);
  const double turn_deg = deg_from_rad(std::acos(std::clamp(towards_scanner(scan).dot(first), -1.0, 1.0)));
  std::string text = "; to join them lay the tablet as for scan " + std::to_string(scan.id);
  if (turn_deg > kLiesSoDeg) {
    text += std::string(", turn ") + spoken(edge.face) + " towards the camera, " +
            std::to_string(std::lround(turn_deg)) + "°";
  }
  return text + ", scan, and scan twice more, each time turned on by 45° over that edge";
}

}  // namespace

std::vector<GroupApart> groups_apart(std::span<const ScanPose> poses, std::span<const PlacedScan> model) {
  std::map<int, std::vector<int>> groups;
  std::vector<int> registered;
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      registered.push_back(pose.id);
    } else if (pose.group_apart >= 0) {
      groups[pose.group_apart].push_back(pose.id);
    }
  }
  // The others of the group may have been taken out since it was found.
  std::erase_if(groups, [](const auto& group) { return group.second.size() < 2; });
  std::vector<GroupApart> out;
  if (groups.empty() || registered.empty()) {
    return out;
  }
  std::ranges::sort(registered);
  const std::optional<JoiningEdge> edge = joining_edge(model);
  const std::string way = edge ? way_over(*edge, model)
                               : std::string(
                                     "; to join them scan the edge between them, held so that both "
                                     "sides are in view");
  for (auto& [first, ids] : groups) {
    std::ranges::sort(ids);
    std::string say = listed_in_runs(ids) + " fit one another, and not " + listed_in_runs(registered) + way +
                      "; or scan both sides again with the same pins standing, or click three places that a "
                      "scan of each shows; take out what is of another tablet";
    out.push_back({std::move(ids), std::move(say)});
  }
  return out;
}

}  // namespace dubsar
