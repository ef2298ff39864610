// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar stitch: one mesh of a session or a folder.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "archive/html.h"
#include "core/log.h"
#include "formats/mesh_io.h"
#include "formats/mesh_losses.h"
#include "station/command/command.h"
#include "station/command/left_out_scans.h"
#include "station/command/outputs.h"
#include "station/command/scan_set_options.h"
#include "station/command/stitch_poses.h"
#include "station/command/stitch_stamp.h"
#include "station/command/stitch_taken.h"
#include "station/mesh_json.h"
#include "station/offline.h"
#include "station/outward_faces.h"
#include "station/poses_scale.h"
#include "station/stitch_scans.h"
#include "station/stitch_warnings.h"
#include "station/tablet_flags.h"
#include "station/tablet_label.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {

namespace {

/// Which samples are foreign only all scans together tell: those that show some are read once more.
Status leave_out_foreign(const ScanSetArguments& arguments, ForeignMatter& matter, Taken& taken,
                         Stitcher& stitcher, CommandContext& context) {
  std::vector<ForeignFound> foreign = matter.find(taken.poses);
  tell_foreign(foreign, taken, stitcher);
  std::erase_if(foreign, [](const ForeignFound& found) { return found.is_all(); });
  if (foreign.empty()) {
    return {};
  }
  ScanSetOptions reading = arguments.reading();
  reading.again = true;
  reading.access = SessionStore::Access::kReadOnly;  // the first reading still holds the session
  const auto take = [&](const ScanSet&, const StationScan& scan) -> Status {
    if (std::ranges::find(foreign, scan.id, &ForeignFound::id) == foreign.end()) {
      return {};
    }
    stitcher.remove(scan.id);
    return add_scan(stitcher, scan,
                    without_foreign(*scan.grid, *scan.flags, matter.matter(scan.id, *scan.grid)),
                    *std::ranges::find(taken.poses, scan.id, &ScanPose::id), context.job);
  };
  const Result<ScanSet> set = visit_scan_set(arguments.path, reading, take, context.job);
  return set ? Status() : std::unexpected(set.error());
}

/// Scan by scan, where the poses are known beforehand. One is made ready while the next is read: no more than
/// two grids are in memory, and a third for a moment where names are looked for in renamed files.
Result<Taken> take_scan_by_scan(const ScanSetArguments& arguments, Stitcher& stitcher,
                                CommandContext& context) {
  if (const Status good = arguments.check_unit(arguments.poses); !good) {
    return std::unexpected(good.error());
  }
  std::optional<GivenPoses> file;
  if (!arguments.poses.empty()) {
    Result<GivenPoses> read = GivenPoses::read(arguments, context.job);
    if (!read) {
      return std::unexpected(read.error());
    }
    file = std::move(*read);
  }
  Taken taken;
  std::size_t with_pose = 0;
  ForeignMatter matter;
  PosesScale scale;
  std::future<Status> adding;
  const auto take = [&](const ScanSet& set, StationScan scan) -> Status {
    const auto stored = std::ranges::find(set.poses, scan.id, &ScanPose::id);
    const Result<const ScanPose*> found = file                        ? file->of(scan, context.job)
                                          : stored == set.poses.end() ? nullptr
                                                                      : &*stored;
    if (!found) {
      return std::unexpected(found.error());
    }
    const ScanPose* pose = *found;
    taken.lacks_poses = taken.lacks_poses || (pose == nullptr && !file);
    if (pose == nullptr && file) {
      taken.leave_out({scan.id, scan.file, LeftOutScan::Why::kNoPose, file->lacks(scan)});
    }
    if (pose == nullptr || taken.lacks_poses) {
      return {};
    }
    // Registration refuses such scans; here nothing else would tell.
    if (const std::string impossible = file ? size_fault(*scan.grid) : ""; !impossible.empty()) {
      return bad_input(scan.file, impossible);
    }
    ++with_pose;
    if (pose->status != PoseStatus::kRegistered) {
      ScanPose named = *pose;
      named.id = scan.id;
      named.file = scan.file;
      taken.leave_out(left_out(named));
      return {};
    }
    ++taken.scans;
    taken.names[scan.id] = scan.file;
    taken.note_file(scan);
    if (file) {
      scale.add(*scan.grid, pose->model_from_scanner);
    }
    const Status before = adding.valid() ? adding.get() : Status{};
    taken.poses.push_back(*pose);
    taken.poses.back().id = scan.id;
    if (file && !file->says_sigma(*pose)) {
      taken.without_sigma.insert(scan.id);
    }
    adding =
        std::async(std::launch::async, [&stitcher, &matter, &context, pose = *pose, scan = std::move(scan)] {
          matter.add(scan.id, *scan.grid, *scan.flags);
          return add_scan(stitcher, scan, *scan.flags, pose, context.job);
        });
    return before;
  };
  const Result<ScanSet> set = visit_scan_set(arguments.path, arguments.reading(), take, context.job);
  const Status last = adding.valid() ? adding.get() : Status{};
  if (!set) {
    return std::unexpected(set.error());
  }
  if (!last) {
    return std::unexpected(last.error());
  }
  if (const std::string fault = scale.fault(); !fault.empty()) {
    log_warning(arguments.poses + ": " + fault);
  }
  if (file && with_pose == 0) {
    return no_pose_of_these(arguments.poses);
  }
  const std::optional<std::vector<ScanPose>> rest = file ? std::optional(file->rest()) : std::nullopt;
  const Status told =
      taken.lacks_poses ? Status() : leave_out_unread(*set, arguments.path, rest ? &*rest : nullptr, taken);
  if (!told) {
    return std::unexpected(told.error());
  }
  const Status left_out =
      taken.lacks_poses ? Status() : leave_out_foreign(arguments, matter, taken, stitcher, context);
  return left_out ? Result<Taken>(std::move(taken)) : std::unexpected(left_out.error());
}

/// With a registration first, which needs all of them.
Result<Taken> take_registered(const ScanSetArguments& arguments, Stitcher& stitcher,
                              CommandContext& context) {
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.reading(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses = poses_for(*set, {}, {}, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  Taken taken;
  for (const StationScan& scan : set->scans) {
    taken.note_file(scan);
  }
  for (const ScanPose& pose : *poses) {
    if (pose.status == PoseStatus::kRegistered) {
      taken.names[pose.id] = pose.file;
      ++taken.scans;
    } else {
      taken.leave_out(left_out(pose));
    }
  }
  if (const Status told = leave_out_unread(*set, arguments.path, nullptr, taken); !told) {
    return std::unexpected(told.error());
  }
  const Result<std::vector<ForeignFound>> foreign =
      add_without_foreign(stitcher, set->scans, *poses, context.job);
  if (!foreign) {
    return std::unexpected(foreign.error());
  }
  tell_foreign(*foreign, taken, stitcher);
  return taken;
}

struct StitchArguments {
  ScanSetArguments set;
  bool unless_done = false;
};

int tell_done(const StitchArguments& arguments, const std::vector<LeftOutScan>& left_out,
              const CommandContext& context) {
  std::ranges::for_each(left_out, warn_of);
  if (context.json) {
    CommandContext::print(
        {{"mesh", arguments.set.out}, {"done_before", true}, {"left_out", left_out_json(left_out)}});
  } else {
    finish_progress();
    std::printf("%s: done before, of the scans as they stand\n", arguments.set.out.c_str());
  }
  return falls_short(left_out) ? 1 : 0;
}

Result<FileLabel> label_of(const std::string& path, const Taken& taken) {
  if (!SessionStore::is_session(path)) {
    std::vector<std::filesystem::path> grids;
    bool made_up = false;
    for (const auto& [id, name] : taken.names) {
      grids.push_back(taken.files.at(id));
      made_up = made_up || taken.made_up.contains(id);
    }
    return label_of_files(grids, made_up);
  }
  const Result<SessionStore> store = SessionStore::open(path, SessionStore::Access::kReadOnly);
  return store ? tablet_label(*store) : std::unexpected(store.error());
}

Result<int> stitch_all(const ScanSetArguments& arguments, const StitchStamp& stamp, CommandContext& context) {
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
  leave_out_copies(*stitcher, *taken);
  leave_out_without_surface(*stitcher, *taken);
  tell_unknown_sigmas(*taken, arguments.poses);
  std::ranges::for_each(warnings_of_places(*stitcher, taken->names), log_warning);
  const nlohmann::ordered_json apart = apart_json(*stitcher);
  const Result<Mesh> mesh = stitcher->take_mesh(context.job);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (const Status has = check_has_surface(*mesh, arguments.path); !has) {
    return std::unexpected(has.error());
  }
  if (const std::optional<Error> wrong_way = inside_out(*mesh, arguments.out)) {
    log_warning(wrong_way->line());
  }
  const Result<FileLabel> label = label_of(arguments.path, *taken);
  if (!label) {
    return std::unexpected(label.error());
  }
  if (const Status started = stamp.work ? stamp.work->start() : Status(); !started) {
    return std::unexpected(started.error());
  }
  if (const Status written = write_mesh(arguments.out, *mesh, *label); !written) {
    return std::unexpected(written.error());
  }
  if (const std::optional<Error> lost =
          mesh_losses(*mesh, arguments.out, "stitch into a .ply to have them")) {
    log_warning(lost->line());
  }
  // A grid that was lost meanwhile is one that the stamp says was read; of one in the way it knows nothing.
  const bool holds = stamp.work && unreadable_of(taken->left_out) == unreadable_of(stamp.left_out) &&
                     std::ranges::count(taken->left_out, LeftOutScan::Why::kInTheWay, &LeftOutScan::why) == 0;
  if (const Status kept = holds ? stamp.work->finish({arguments.out}, context.job) : Status(); !kept) {
    return std::unexpected(kept.error());
  }
  if (context.json) {
    nlohmann::ordered_json json{{"mesh", arguments.out},
                                {"scans", taken->scans},
                                {"left_out", left_out_json(taken->left_out)},
                                {"apart", apart}};
    json.update(mesh_report_json(check_mesh(*mesh, context.job)));
    if (context.job.cancelled()) {
      return fail(ErrorKind::kCancelled, "its mesh is written, but the check of it was stopped",
                  arguments.out);
    }
    CommandContext::print(json);
  } else {
    const MeshReport report = check_manifold(*mesh);
    finish_progress();
    const std::string others =
        taken->left_out.empty() ? "" : fmt::format(" ({} left out)", taken->left_out.size());
    std::printf("%s: %zu vertices, %zu faces of %s%s, %s\n", arguments.out.c_str(), report.vertices,
                report.faces, counted(static_cast<long long>(taken->scans), "scan", "scans").c_str(),
                others.c_str(), report.is_manifold() ? "2-manifold" : "NOT 2-manifold");
  }
  return falls_short(taken->left_out) ? 1 : 0;
}

Result<int> stitch(const StitchArguments& arguments, CommandContext& context) {
  if (const Status named = check_mesh_name(arguments.set.out); !named) {
    return std::unexpected(named.error());
  }
  const Result<StitchStamp> stamp = arguments.unless_done && SessionStore::is_session(arguments.set.path)
                                        ? begin_stitch(arguments.set.path, arguments.set.out, context.job)
                                        : StitchStamp();
  if (!stamp) {
    return std::unexpected(stamp.error());
  }
  const Result<bool> done = stamp->work ? stamp->work->done(context.job) : false;
  if (!done) {
    return std::unexpected(done.error());
  }
  return *done ? tell_done(arguments, stamp->left_out, context) : stitch_all(arguments.set, *stamp, context);
}

}  // namespace

void add_stitch(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand(
      "stitch",
      "One mesh of all registered scans; status 1 when one of them cannot be read, or stands in the way of "
      "others with all that it has");
  const auto arguments = std::make_shared<StitchArguments>();
  arguments->set.add_to(*verb, true);
  verb->add_option(
          "-o,--out", arguments->set.out,
          "the mesh: PLY, which holds all that is known of it, OBJ, STL or GLB; .draco.glb compresses")
      ->required();
  verb->add_flag(
          "--unless-done", arguments->unless_done,
          "of a session: leave a stamp, and do nothing where it tells that the mesh is of the scans as "
          "they stand")
      ->excludes(verb->get_option("--poses"))
      ->excludes(verb->get_option("--pins"));
  verb->callback([&chosen, arguments] {
    chosen = with_safe_outputs({arguments->set.out},
                               [arguments](CommandContext& c) { return stitch(*arguments, c); },
                               {arguments->set.poses, arguments->set.pins});
  });
}

}  // namespace dubsar
