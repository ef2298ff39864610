// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar stitch: one mesh of a session or a folder.

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "core/log.h"
#include "formats/mesh_io.h"
#include "station/command/command.h"
#include "station/command/scan_set_options.h"
#include "station/mesh_json.h"
#include "station/offline.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {

namespace {

Result<int> stitch_all(const ScanSetArguments& arguments, CommandContext& context) {
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.options(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses = poses_for(*set, arguments.poses, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const std::vector<PlacedScan> placed = placed_scans(*set, *poses);
  if (placed.empty()) {
    return bad_input(arguments.path, "no scan is registered", "see dubsar register");
  }
  for (const ScanPose& pose : *poses) {
    if (pose.status != PoseStatus::kRegistered) {
      log_warning(pose.file + " is left out: " + to_string(pose.status) +
                  (pose.reason.empty() ? "" : ", " + pose.reason));
    }
  }
  Stitcher stitcher;
  if (const Status added = stitcher.add(placed, context.job); !added) {
    return std::unexpected(added.error());
  }
  const Result<Mesh> mesh = stitcher.mesh(context.job);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  for (const Stitcher::Overlap& overlap : stitcher.overlaps()) {
    if (overlap.is_off()) {
      log_warning(
          fmt::format("scans {} and {} lie {:.2f} mm apart where they overlap, more than noise explains; the "
                      "mesh is less reliable there; register them again",
                      overlap.id, overlap.other_id, overlap.step_mm));
    }
  }
  if (const Status written = write_mesh(arguments.out, *mesh); !written) {
    return std::unexpected(written.error());
  }
  const MeshReport report = check_mesh(*mesh);
  nlohmann::ordered_json json{{"mesh", arguments.out}, {"scans", placed.size()}};
  json.update(mesh_report_json(report));
  if (context.json) {
    CommandContext::print(json);
  } else {
    finish_progress();
    std::printf("%s: %zu vertices, %zu faces of %zu scans, %s\n", arguments.out.c_str(), report.vertices,
                report.faces, placed.size(), report.is_manifold() ? "2-manifold" : "NOT 2-manifold");
  }
  return 0;
}

}  // namespace

void add_stitch(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("stitch", "One mesh of all registered scans");
  const auto arguments = std::make_shared<ScanSetArguments>();
  arguments->add_to(*verb, true);
  verb->add_option("-o,--out", arguments->out, "the mesh: PLY, OBJ, STL or GLB")->required();
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return stitch_all(*arguments, c); };
  });
}

}  // namespace dubsar
