// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar plan: the red map and the next view of a session or a folder.

#include <cstdio>
#include <memory>

#include "formats/red_map_json.h"
#include "station/command/command.h"
#include "station/command/scan_set_options.h"
#include "station/offline.h"
#include "station/planning_stage.h"

namespace dubsar {

namespace {

void print_map(const RedMap& map) {
  std::printf("%s\n", map.conclusive ? "conclusive" : "not conclusive");
  for (const RedRegion& region : map.regions) {
    std::printf("  %-8s %-8s %8.2f mm2 at %.1f %.1f %.1f%s%s\n",
                region.state == RegionState::kRed ? "red" : "excused", to_string(region.face),
                region.area_mm2, region.center_mm.x(), region.center_mm.y(), region.center_mm.z(),
                region.reason.empty() ? "" : ": ", region.reason.c_str());
  }
  for (const NextView& view : map.next) {
    std::printf("  next: %s (about %.1f mm2)\n", view.say.c_str(), view.predicted_cleared_mm2);
  }
}

Result<int> plan(const ScanSetArguments& arguments, CommandContext& context) {
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.options(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses = poses_for(*set, arguments.poses, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  PlanningStage stage;
  for (const StationScan& scan : set->scans) {
    stage.add(scan);
  }
  if (const Status placed = stage.place(*poses, true, context.job); !placed) {
    return std::unexpected(placed.error());
  }
  const Result<RedMap> map = stage.red_map(set->rig ? &*set->rig : nullptr, context.job);
  if (!map) {
    return std::unexpected(map.error());
  }
  const std::string json = red_map_to_json(*map);
  if (set->is_session()) {
    if (const Status saved = set->store->save_document("red_map", json); !saved) {
      return std::unexpected(saved.error());
    }
  }
  if (!arguments.out.empty()) {
    if (const Status written = write_red_map(arguments.out, *map); !written) {
      return std::unexpected(written.error());
    }
  }
  finish_progress();
  if (context.json) {
    CommandContext::print(nlohmann::ordered_json::parse(json));
  } else {
    print_map(*map);
  }
  return map->conclusive ? 0 : 1;
}

}  // namespace

void add_plan(CLI::App& app, Action& chosen) {
  CLI::App* verb =
      app.add_subcommand("plan", "What is still red and where to scan next; status 1 when not conclusive");
  const auto arguments = std::make_shared<ScanSetArguments>();
  arguments->add_to(*verb, true);
  verb->add_option("-o,--out", arguments->out, "write red_map.json here");
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return plan(*arguments, c); }; });
}

}  // namespace dubsar
