// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar stitch: one mesh of a session or a folder.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "core/log.h"
#include "formats/mesh_io.h"
#include "station/command/command.h"
#include "station/command/outputs.h"
#include "station/command/scan_set_options.h"
#include "station/mesh_json.h"
#include "station/offline.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {

namespace {

/// What a stitcher was given.
struct Taken {
  std::size_t scans = 0;
  bool lacks_poses = false;  ///< of a scan that has not been judged yet: then the rest was not taken
};

void warn_left_out(const ScanPose& pose) {
  log_warning(pose.file + " is left out: " + to_string(pose.status) +
              (pose.reason.empty() ? "" : ", " + pose.reason));
}

/// Scan by scan, where the poses are known beforehand. One is made ready while the next is read: no more than
/// two grids are in memory.
Result<Taken> take_scan_by_scan(const ScanSetArguments& arguments, Stitcher& stitcher,
                                CommandContext& context) {
  std::optional<std::vector<ScanPose>> file;
  if (!arguments.poses.empty()) {
    Result<std::vector<ScanPose>> read = read_poses_file(arguments.poses, arguments.unit);
    if (!read) {
      return std::unexpected(read.error());
    }
    file = std::move(*read);
  }
  Taken taken;
  std::size_t with_pose = 0;
  std::future<Status> adding;
  const auto take = [&](const ScanSet& set, StationScan scan) -> Status {
    const auto stored = std::ranges::find(set.poses, scan.id, &ScanPose::id);
    const ScanPose* pose = file ? pose_in_file(*file, scan) : stored == set.poses.end() ? nullptr : &*stored;
    taken.lacks_poses = taken.lacks_poses || (pose == nullptr && !file);
    if (pose == nullptr || taken.lacks_poses) {
      return {};
    }
    ++with_pose;
    if (pose->status != PoseStatus::kRegistered) {
      ScanPose named = *pose;
      named.file = scan.file;
      warn_left_out(named);
      return {};
    }
    ++taken.scans;
    const Status before = adding.valid() ? adding.get() : Status{};
    adding = std::async(std::launch::async, [&stitcher, &context, pose = *pose, scan = std::move(scan)] {
      return stitcher.add(
          {scan.id, scan.grid.get(), scan.flags.get(), pose.model_from_scanner, pose.sigma_mm}, context.job);
    });
    return before;
  };
  const Result<ScanSet> set = visit_scan_set(arguments.path, arguments.options(), take, context.job);
  const Status last = adding.valid() ? adding.get() : Status{};
  if (!set) {
    return std::unexpected(set.error());
  }
  if (!last) {
    return std::unexpected(last.error());
  }
  if (file && with_pose == 0) {
    return no_pose_of_these(arguments.poses);
  }
  return taken;
}

/// With a registration first, which needs all of them.
Result<Taken> take_registered(const ScanSetArguments& arguments, Stitcher& stitcher,
                              CommandContext& context) {
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.options(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses = poses_for(*set, {}, {}, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  for (const ScanPose& pose : *poses) {
    if (pose.status != PoseStatus::kRegistered) {
      warn_left_out(pose);
    }
  }
  const std::vector<PlacedScan> placed = placed_scans(*set, *poses);
  if (const Status added = stitcher.add(placed, context.job); !added) {
    return std::unexpected(added.error());
  }
  return Taken{placed.size(), false};
}

Result<int> stitch_all(const ScanSetArguments& arguments, CommandContext& context) {
  auto stitcher = std::make_unique<Stitcher>();
  const bool has_poses = !arguments.poses.empty() || SessionStore::is_session(arguments.path);
  Result<Taken> taken = has_poses ? take_scan_by_scan(arguments, *stitcher, context)
                                  : take_registered(arguments, *stitcher, context);
  if (taken && taken->lacks_poses) {
    stitcher = std::make_unique<Stitcher>();
    taken = take_registered(arguments, *stitcher, context);
  }
  if (!taken) {
    return std::unexpected(taken.error());
  }
  if (taken->scans == 0) {
    return bad_input(arguments.path, "no scan is registered", "see dubsar register");
  }
  for (const Stitcher::Overlap& overlap : stitcher->overlaps()) {
    if (overlap.is_off()) {
      log_warning(
          fmt::format("scans {} and {} lie {:.2f} mm apart where they overlap, more than noise explains; the "
                      "mesh is less reliable there; register them again",
                      overlap.id, overlap.other_id, overlap.step_mm));
    }
  }
  const Result<Mesh> mesh = stitcher->take_mesh(context.job);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (const Status written = write_mesh(arguments.out, *mesh); !written) {
    return std::unexpected(written.error());
  }
  if (context.json) {
    nlohmann::ordered_json json{{"mesh", arguments.out}, {"scans", taken->scans}};
    json.update(mesh_report_json(check_mesh(*mesh)));
    CommandContext::print(json);
  } else {
    const MeshReport report = check_manifold(*mesh);
    finish_progress();
    std::printf("%s: %zu vertices, %zu faces of %zu scans, %s\n", arguments.out.c_str(), report.vertices,
                report.faces, taken->scans, report.is_manifold() ? "2-manifold" : "NOT 2-manifold");
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
    chosen = outside_sessions({arguments->out},
                              [arguments](CommandContext& c) { return stitch_all(*arguments, c); });
  });
}

}  // namespace dubsar
