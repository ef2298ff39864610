// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/plan_again.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/log.h"
#include "formats/red_map_json.h"
#include "triangulation/placed_precision.h"

namespace dubsar {

namespace {

/// Those of the set's scans; one that was stored registered where the model cannot hold it is failed.
std::vector<ScanPose> poses_in(const ScanSet& set, const std::vector<ScanPose>& poses) {
  std::vector<ScanPose> out;
  for (const ScanPose& pose : poses) {
    const auto scan = std::ranges::find(set.scans, pose.id, &StationScan::id);
    if (scan == set.scans.end()) {
      continue;
    }
    out.push_back(PlacedPrecision(*scan->grid).judged(pose));
    if (out.back().status != pose.status) {
      log_warning(scan->file + " is left out: " + out.back().reason);
    }
  }
  return out;
}

Result<RedMap> red_map_again(const ScanSet& set, const std::vector<ScanPose>& poses, PlanningStage& stage,
                             JobContext& job) {
  for (const StationScan& scan : set.scans) {
    stage.add(scan);
  }
  if (const Status placed = stage.place(poses, true, job); !placed) {
    return std::unexpected(placed.error());
  }
  return stage.red_map(set.rig ? &*set.rig : nullptr, job);
}

}  // namespace

Result<ColouredPoints> red_points_again(const ScanSet& set, const std::vector<ScanPose>& poses,
                                        const Mesh& mesh, JobContext& job) {
  PlanningStage stage;
  const Result<RedMap> map = red_map_again(set, poses_in(set, poses), stage, job);
  return map ? Result<ColouredPoints>(stage.red_points(mesh)) : std::unexpected(map.error());
}

Result<PlannedAgain> plan_again(const ScanSet& set, const std::vector<ScanPose>& poses, JobContext& job) {
  PlannedAgain out;
  out.stage = std::make_unique<PlanningStage>();
  out.results.poses = poses_in(set, poses);
  const Rig* rig = set.rig ? &*set.rig : nullptr;
  Result<RedMap> map = red_map_again(set, out.results.poses, *out.stage, job);
  if (!map) {
    return std::unexpected(map.error());
  }
  out.results.red_map = std::move(*map);
  if (std::optional<Mesh> stored =
          set.store ? stored_mesh(*set.store, out.results.poses, job) : std::nullopt) {
    out.results.mesh = std::move(*stored);
  } else {
    Result<Mesh> mesh = out.stage->mesh(job);
    if (!mesh) {
      return std::unexpected(mesh.error());
    }
    out.results.mesh = std::move(*mesh);
  }
  Result<Checklist> list = checklist_of(out.results.red_map, out.results.poses, *out.stage, out.results.mesh,
                                        rig, set.store ? &*set.store : nullptr, job);
  if (!list) {
    return std::unexpected(list.error());
  }
  out.results.checklist = std::move(*list);
  return out;
}

Result<std::optional<std::vector<std::string>>> differs_from_stored(const SessionStore& store,
                                                                    const RedMap& anew) {
  const Result<std::optional<std::string>> text = store.load_document("red_map");
  if (!text) {
    return std::unexpected(text.error());
  }
  if (!*text) {
    return std::optional<std::vector<std::string>>();
  }
  const Result<RedMap> stored = parse_red_map(**text, store.folder().string() + " (red map)");
  if (!stored) {
    return std::unexpected(stored.error());
  }
  std::vector<std::string> out;
  if (stored->conclusive != anew.conclusive) {
    out.emplace_back(anew.conclusive ? "the verdict: stored not conclusive, now conclusive"
                                     : "the verdict: stored conclusive, now not conclusive");
  }
  const std::string now = red_map_to_json(anew);
  if (now == **text) {
    return std::optional(out);
  }
  // The texts hold every digit; they are compared part by part for the words.
  const auto a = nlohmann::json::parse(**text, nullptr, false);
  const auto b = nlohmann::json::parse(now, nullptr, false);
  const auto differs = [&](const char* part) { return a.value(part, nlohmann::json()) != b[part]; };
  const nlohmann::json none;
  if (a.value("copies", none) != b.value("copies", none)) {
    out.emplace_back("the scans that are copies of others");
  }
  if (differs("scans")) {
    out.push_back(a["scans"].size() == b["scans"].size()
                      ? "the counts of samples"
                      : "the scans: stored " + std::to_string(stored->scans.size()) + ", now " +
                            std::to_string(anew.scans.size()));
  }
  if (differs("regions")) {
    out.push_back(stored->regions.size() == anew.regions.size()
                      ? "the places or sizes of the regions"
                      : "the regions: stored " + std::to_string(stored->regions.size()) + ", now " +
                            std::to_string(anew.regions.size()));
  }
  if (differs("next")) {
    out.emplace_back("the next placements");
  }
  return std::optional(out);
}

}  // namespace dubsar
