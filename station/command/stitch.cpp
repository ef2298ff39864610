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
#include <vector>

#include "archive/html.h"
#include "core/log.h"
#include "formats/mesh_io.h"
#include "formats/mesh_losses.h"
#include "registration/registrar.h"
#include "registration/unit_check.h"
#include "station/command/command.h"
#include "station/command/outputs.h"
#include "station/command/scan_set_options.h"
#include "station/command/stitch_warnings.h"
#include "station/done_stamp.h"
#include "station/mesh_json.h"
#include "station/offline.h"
#include "station/outward_faces.h"
#include "station/results.h"
#include "station/tablet_flags.h"
#include "station/tablet_label.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {

namespace {

/// What a stitcher was given.
struct Taken {
  std::size_t scans = 0;
  std::map<int, std::string> names;  ///< of those, by id
  bool lacks_poses = false;          ///< of a scan that has not been judged yet: then the rest was not taken
  std::vector<ScanPose> poses;       ///< of those
};

/// Why the grid cannot be in the unit that was said; empty when it may be.
std::string size_fault(const RangeGrid& grid) {
  const RegistrationOptions usual;
  const double scale_mm = surface_scale_mm(grid);
  return scale_mm > 0 ? impossible_size({scale_mm, grid.spacing_mm}, usual.least_size_mm, usual.most_size_mm)
                      : "";
}

void warn_left_out(const ScanPose& pose) {
  log_warning(pose.file + " is left out: " + to_string(pose.status) +
              (pose.reason.empty() ? "" : ", " + pose.reason));
}

/// What the stitcher refuses is named by its file.
Status put(Stitcher& stitcher, const StationScan& scan, const SampleFlags& flags, const ScanPose& pose,
           const CommandContext& context) {
  Status added =
      stitcher.add({scan.id, scan.grid.get(), &flags, pose.model_from_scanner, pose.sigma_mm}, context.job);
  if (!added && added.error().kind == ErrorKind::kBadInput) {
    added.error().where = scan.file;
  }
  return added;
}

/// Which samples are foreign only all scans together tell: those that show some are read once more.
Status leave_out_foreign(const ScanSetArguments& arguments, const Taken& taken, ForeignMatter& matter,
                         Stitcher& stitcher, CommandContext& context) {
  const std::vector<ForeignFound> foreign = matter.find(taken.poses);
  if (foreign.empty()) {
    return {};
  }
  for (const ForeignFound& found : foreign) {
    log_warning(sentence_of(found));
  }
  ScanSetOptions reading = arguments.reading();
  reading.again = true;
  reading.access = SessionStore::Access::kReadOnly;  // the first reading still holds the session
  const auto take = [&](const ScanSet&, const StationScan& scan) -> Status {
    if (std::ranges::find(foreign, scan.id, &ForeignFound::id) == foreign.end()) {
      return {};
    }
    stitcher.remove(scan.id);
    return put(stitcher, scan, without_foreign(*scan.grid, *scan.flags, matter.matter(scan.id, *scan.grid)),
               *std::ranges::find(taken.poses, scan.id, &ScanPose::id), context);
  };
  const Result<ScanSet> set = visit_scan_set(arguments.path, reading, take, context.job);
  return set ? Status() : std::unexpected(set.error());
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
  ForeignMatter matter;
  std::future<Status> adding;
  const auto take = [&](const ScanSet& set, StationScan scan) -> Status {
    const auto stored = std::ranges::find(set.poses, scan.id, &ScanPose::id);
    const ScanPose* pose = file ? pose_in_file(*file, scan) : stored == set.poses.end() ? nullptr : &*stored;
    taken.lacks_poses = taken.lacks_poses || (pose == nullptr && !file);
    if (pose == nullptr && file) {
      log_warning(scan.file + " is left out: " + arguments.poses + " has no pose of it");
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
      named.file = scan.file;
      warn_left_out(named);
      return {};
    }
    ++taken.scans;
    taken.names[scan.id] = scan.file;
    const Status before = adding.valid() ? adding.get() : Status{};
    taken.poses.push_back(*pose);
    taken.poses.back().id = scan.id;
    adding =
        std::async(std::launch::async, [&stitcher, &matter, &context, pose = *pose, scan = std::move(scan)] {
          matter.add(scan.id, *scan.grid, *scan.flags);
          return put(stitcher, scan, *scan.flags, pose, context);
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
  if (file && with_pose == 0) {
    return no_pose_of_these(arguments.poses);
  }
  const Status left_out =
      taken.lacks_poses ? Status() : leave_out_foreign(arguments, taken, matter, stitcher, context);
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
  for (const ScanPose& pose : *poses) {
    if (pose.status != PoseStatus::kRegistered) {
      warn_left_out(pose);
    }
  }
  std::vector<PlacedScan> placed = placed_scans(*set, *poses);
  TabletFlags flags;
  for (const StationScan& scan : set->scans) {
    flags.add(scan);
  }
  flags.follow(*poses);
  for (PlacedScan& scan : placed) {
    scan.flags = &flags.of(scan.id);
  }
  for (const ForeignFound& found : flags.foreign()) {
    log_warning(sentence_of(found));
  }
  if (const Status added = stitcher.add(placed, context.job); !added) {
    return std::unexpected(added.error());
  }
  Taken taken{placed.size(), {}, false, {}};
  for (const ScanPose& pose : *poses) {
    if (pose.status == PoseStatus::kRegistered) {
      taken.names[pose.id] = pose.file;
    }
  }
  return taken;
}

struct StitchArguments {
  ScanSetArguments set;
  bool unless_done = false;
};

/// Stamped work is told by the grids and where the session has them lie. Nothing where that does not decide
/// the mesh: a folder is registered anew, and so is a session with a scan that has not been judged yet.
Result<std::optional<StampedWork>> begin_work(const StitchArguments& arguments, CommandContext& context) {
  const std::filesystem::path session = arguments.set.path;
  if (!arguments.unless_done || !SessionStore::is_session(session)) {
    return std::nullopt;
  }
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  const auto scans = store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Result<std::vector<ScanPose>> poses = standing_poses(*store);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  std::vector<std::filesystem::path> grids;
  for (const StoredScan& scan : *scans) {
    if (scan.dropped || scan.damaged) {
      continue;
    }
    std::error_code gone;
    grids.push_back(session / scan.file);
    if (std::ranges::find(*poses, scan.id, &ScanPose::id) == poses->end() ||
        !std::filesystem::is_regular_file(grids.back(), gone)) {
      return std::nullopt;
    }
  }
  const Result<FileLabel> label = tablet_label(*store);
  if (!label) {
    return std::unexpected(label.error());
  }
  const nlohmann::ordered_json parameters{
      {"label", label_lines(*label, "")},
      {"out", std::filesystem::path(arguments.set.out).filename().string()},
      {"origin", origin_of_mesh(*poses)}};
  return StampedWork::begin(stamp_beside(arguments.set.out), "stitch", parameters.dump(), grids, context.job);
}

int tell_done(const StitchArguments& arguments, const CommandContext& context) {
  if (context.json) {
    CommandContext::print({{"mesh", arguments.set.out}, {"done_before", true}});
  } else {
    finish_progress();
    std::printf("%s: done before, of the scans as they stand\n", arguments.set.out.c_str());
  }
  return 0;
}

Result<FileLabel> label_of(const std::string& path, const std::map<int, std::string>& names) {
  if (!SessionStore::is_session(path)) {
    std::error_code ignored;
    const std::filesystem::path set = path;
    const bool is_folder = std::filesystem::is_directory(set, ignored);
    std::vector<std::filesystem::path> grids;
    for (const auto& [id, name] : names) {
      grids.push_back(is_folder ? set / name : set);
    }
    return label_of_files(grids);
  }
  const Result<SessionStore> store = SessionStore::open(path, SessionStore::Access::kReadOnly);
  return store ? tablet_label(*store) : std::unexpected(store.error());
}

Result<int> stitch_all(const ScanSetArguments& arguments, const StampedWork* work, CommandContext& context) {
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
  taken->scans -= stitcher->copies().size();
  leave_out_copies(*stitcher, taken->names);
  warn_of_places(*stitcher, taken->names);
  const Result<Mesh> mesh = stitcher->take_mesh(context.job);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (mesh->faces.empty()) {
    return bad_input(arguments.path,
                     fmt::format("its scans have no surface: nowhere do {} triangles of neighbouring samples "
                                 "hang together",
                                 StitchOptions().least_component_faces),
                     "scan again, nearer or with more of the tablet in view");
  }
  if (const std::optional<Error> wrong_way = inside_out(*mesh, arguments.out)) {
    log_warning(wrong_way->line());
  }
  const Result<FileLabel> label = label_of(arguments.path, taken->names);
  if (!label) {
    return std::unexpected(label.error());
  }
  if (const Status started = work != nullptr ? work->start() : Status(); !started) {
    return std::unexpected(started.error());
  }
  if (const Status written = write_mesh(arguments.out, *mesh, *label); !written) {
    return std::unexpected(written.error());
  }
  if (const std::optional<Error> lost =
          mesh_losses(*mesh, arguments.out, "stitch into a .ply to have them")) {
    log_warning(lost->line());
  }
  if (const Status kept = work != nullptr ? work->finish({arguments.out}, context.job) : Status(); !kept) {
    return std::unexpected(kept.error());
  }
  if (context.json) {
    nlohmann::ordered_json json{{"mesh", arguments.out}, {"scans", taken->scans}};
    json.update(mesh_report_json(check_mesh(*mesh, context.job)));
    if (context.job.cancelled()) {
      return fail(ErrorKind::kCancelled, "its mesh is written, but the check of it was stopped",
                  arguments.out);
    }
    CommandContext::print(json);
  } else {
    const MeshReport report = check_manifold(*mesh);
    finish_progress();
    std::printf("%s: %zu vertices, %zu faces of %s, %s\n", arguments.out.c_str(), report.vertices,
                report.faces, counted(static_cast<long long>(taken->scans), "scan", "scans").c_str(),
                report.is_manifold() ? "2-manifold" : "NOT 2-manifold");
  }
  return 0;
}

Result<int> stitch(const StitchArguments& arguments, CommandContext& context) {
  if (const Status named = check_mesh_name(arguments.set.out); !named) {
    return std::unexpected(named.error());
  }
  const Result<std::optional<StampedWork>> work = begin_work(arguments, context);
  if (!work) {
    return std::unexpected(work.error());
  }
  const Result<bool> done = *work ? (*work)->done(context.job) : false;
  if (!done) {
    return std::unexpected(done.error());
  }
  return *done ? tell_done(arguments, context)
               : stitch_all(arguments.set, *work ? &**work : nullptr, context);
}

}  // namespace

void add_stitch(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("stitch", "One mesh of all registered scans");
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
