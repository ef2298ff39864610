// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/offline.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "core/log.h"
#include "core/units.h"
#include "formats/poses_conf.h"
#include "formats/poses_json.h"
#include "registration/registrar.h"
#include "station/conf_unit.h"
#include "station/lock_places.h"
#include "station/poses_by_id.h"
#include "station/poses_scale.h"
#include "triangulation/placed_precision.h"

namespace dubsar {

namespace {

const ScanPose* pose_of(const std::vector<ScanPose>& poses, int id) {
  const auto found = std::ranges::find(poses, id, &ScanPose::id);
  return found == poses.end() ? nullptr : &*found;
}

/// How a scan goes into the registrar.
enum class Entry {
  kSearched,
  kGiven,    ///< from a pose, refined and verified
  kLocked,   ///< by the operator
  kStaying,  ///< as it was, for this run only
  kLeftOut,
};

struct PlannedEntry {
  const StationScan* scan = nullptr;
  Entry entry = Entry::kSearched;
  RigidTransform pose;
  std::string why;  ///< it is left out
};

PlannedEntry plan_entry(const StationScan& scan, const ScanSet& set, const RegisterOptions& options,
                        std::optional<std::int64_t> frame) {
  const bool named = options.only.empty() || std::ranges::find(options.only, scan.id) != options.only.end();
  const ScanPose* base = pose_of(options.from_poses ? *options.from_poses : set.poses, scan.id);
  if (const auto locked = set.word.locked.find(scan.id); locked != set.word.locked.end()) {
    if (!options.only.empty()) {  // the others stay: it stands in their frame, or is looked for
      return base != nullptr && base->status == PoseStatus::kRegistered
                 ? PlannedEntry{&scan, Entry::kLocked, base->model_from_scanner, {}}
                 : PlannedEntry{&scan, Entry::kSearched, {}, {}};
    }
    if (locked->second.frame == frame) {
      return {&scan, Entry::kLocked, locked->second.model_from_scanner, {}};
    }
  }
  if (!named) {
    return base != nullptr && base->status == PoseStatus::kRegistered
               ? PlannedEntry{&scan, Entry::kStaying, base->model_from_scanner, {}}
               : PlannedEntry{&scan, Entry::kLeftOut, {}, "it was left out of this run"};
  }
  if (!options.from_poses) {
    return {&scan, Entry::kSearched, {}, {}};
  }
  return base != nullptr ? PlannedEntry{&scan, Entry::kGiven, base->model_from_scanner, {}}
                         : PlannedEntry{&scan, Entry::kLeftOut, {}, "there is no pose for it to start from"};
}

/// What the registrar is given: without pins neither clicks nor the word that some stand there.
std::shared_ptr<const RangeGrid> grid_for(const StationScan& scan, bool use_pins) {
  if (use_pins || scan.measured->pin_tip_diameter_mm <= 0) {
    return scan.measured;
  }
  RangeGrid bare = *scan.grid;
  bare.pin_tip_diameter_mm = 0;
  return std::make_shared<const RangeGrid>(std::move(bare));
}

Status check_only(const ScanSet& set, const std::vector<int>& only) {
  for (const int id : only) {
    const std::string name = "scan " + std::to_string(id);
    if (std::ranges::find(set.scans, id, &StationScan::id) == set.scans.end()) {
      if (const Status stands = set.store ? check_scan_stands(*set.store, id) : Status(); !stands) {
        return stands;
      }
      return set.store ? bad_input(set.store->folder().string(), name + " cannot be read",
                                   "look at the disk, or bring it back from a copy")
                       : fail(ErrorKind::kUsage, "there is no " + name, "--only", "see the list of scans");
    }
    if (set.word.locked.contains(id)) {
      return fail(ErrorKind::kUsage, name + " is locked", "--only", "unlock it first");
    }
  }
  return {};
}

}  // namespace

Result<std::vector<ScanPose>> register_scans(const ScanSet& set, const RegisterOptions& options,
                                             JobContext& job) {
  if (const Status good = check_only(set, options.only); !good) {
    return std::unexpected(good.error());
  }
  RegistrationOptions registration;
  registration.final_rounds = options.rounds.value_or(registration.final_rounds);
  Registrar registrar(registration);
  const PinSet* pins = set.pins && options.use_pins ? &*set.pins : nullptr;
  for (const auto& [id, hint] : set.word.hints) {
    if (const Status given = registrar.set_hint(id, hint, job); !given) {
      log_warning(given.error().line());
    }
  }
  const auto frame = frame_of_locks(set.word.locked, [&](int id) {
    return std::ranges::find(set.scans, id, &StationScan::id) != set.scans.end();
  });
  std::vector<PlannedEntry> entries;
  entries.reserve(set.scans.size());
  for (const StationScan& scan : set.scans) {
    entries.push_back(plan_entry(scan, set, options, frame));
  }
  // What stands fast comes first: the others are registered to it, and its frame is the model's.
  std::ranges::stable_partition(
      entries, [](const PlannedEntry& e) { return e.entry == Entry::kLocked || e.entry == Entry::kStaying; });
  for (std::size_t k = 0; k < entries.size(); ++k) {
    job.progress("registering", static_cast<double>(k) / static_cast<double>(entries.size() + 1));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped", {}, "the poses are as they were");
    }
    const PlannedEntry& e = entries[k];
    if (e.entry == Entry::kLeftOut) {
      continue;
    }
    const std::shared_ptr<const RangeGrid> grid = grid_for(*e.scan, options.use_pins);
    if (e.entry == Entry::kSearched) {
      registrar.add(e.scan->id, grid, pins, job);
    } else {
      registrar.add_at(e.scan->id, grid, pins, e.pose, e.entry != Entry::kGiven, job);
    }
  }
  if (const Status done = registrar.finalize(job); !done) {
    return std::unexpected(done.error());
  }
  const SettledLocks locks = settle_locks(registrar, set.word.locked, job);
  if (const Status done = locks.placed ? registrar.finalize(job) : Status(); !done) {
    return std::unexpected(done.error());
  }
  job.progress("registering", 1.0);
  std::vector<ScanPose> poses = registrar.poses();
  tell_contradicted(poses, locks.contradicted);
  for (const PlannedEntry& e : entries) {
    if (e.entry == Entry::kLeftOut) {
      ScanPose left_out;
      left_out.id = e.scan->id;
      left_out.reason = e.why;
      // What was known of it still is.
      const ScanPose* known = options.from_poses ? nullptr : pose_of(set.poses, e.scan->id);
      poses.push_back(known != nullptr ? *known : left_out);
    } else if (e.entry == Entry::kStaying) {
      *std::ranges::find(poses, e.scan->id, &ScanPose::id) =
          *pose_of(options.from_poses ? *options.from_poses : set.poses, e.scan->id);
    }
  }
  std::ranges::sort(poses, {}, &ScanPose::id);
  for (ScanPose& pose : poses) {
    const StationScan& scan = *std::ranges::find(set.scans, pose.id, &StationScan::id);
    pose.file = scan.file;
    pose = PlacedPrecision(*scan.grid).judged(std::move(pose));
  }
  return poses;
}

namespace {

/// By which a pose of a file is known: whatever folder its scan lay in then.
std::string name_of(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

/// That of its file, where it is known by another: a PLY may say how its scan was called. Empty for one of
/// several scans of a file ("tablet.ptx#2").
std::string own_name_of(const StationScan& scan) {
  std::string own = scan.read_from.filename().string();
  return name_of(scan.file).starts_with(own + "#") ? std::string() : own;
}

/// How well a pose fits a scan, the best first. Of those that have its original name: the one whose file is
/// called so too, or has the number in its session.
enum class Claim { kPacked, kNameAndMore, kName, kOwnName, kNumber };

/// Whether a path ends in that one, which is relative.
bool lies_at(const std::filesystem::path& whole, const std::filesystem::path& end) {
  const auto parts = std::distance(end.begin(), end.end());
  return parts > 0 && parts < std::distance(whole.begin(), whole.end()) &&
         std::equal(end.begin(), end.end(), std::prev(whole.end(), parts));
}

bool lies_where_packed(const StationScan& scan, const ScanPose& pose) {
  return std::ranges::any_of(pose.packed_as,
                             [&](const std::string& path) { return lies_at(scan.read_from, path); });
}

Claim claim_of(const StationScan& scan, const ScanPose& pose) {
  if (lies_where_packed(scan, pose)) {
    return Claim::kPacked;
  }
  const std::string name = name_of(pose.file);
  const std::string own = own_name_of(scan);
  if (!name.empty() && name == name_of(scan.file)) {
    const bool more = scan.read_from.empty() ? pose.id == scan.id : own.empty() || own == name;
    return more ? Claim::kNameAndMore : Claim::kName;
  }
  return !name.empty() && name == own && pose.packed_as.empty() ? Claim::kOwnName : Claim::kNumber;
}

}  // namespace

const ScanPose* pose_in_file(const std::vector<ScanPose>& file, const StationScan& scan) {
  const auto the_one = [&](const auto& is_it) -> const ScanPose* {
    const auto found = std::ranges::find_if(file, is_it);
    return found == file.end() || std::any_of(std::next(found), file.end(), is_it) ? nullptr : &*found;
  };
  const ScanPose* found = the_one([&](const ScanPose& pose) { return lies_where_packed(scan, pose); });
  if (found == nullptr) {
    found = the_one(
        [&](const ScanPose& pose) { return !pose.file.empty() && name_of(pose.file) == name_of(scan.file); });
  }
  if (const std::string own = own_name_of(scan); found == nullptr && !own.empty()) {
    found =
        the_one([&](const ScanPose& pose) { return pose.packed_as.empty() && name_of(pose.file) == own; });
  }
  return found != nullptr ? found : the_one([&](const ScanPose& pose) {
    // A session may have two scans of one name, and keeps their numbers.
    const bool is_named = scan.read_from.empty() && name_of(pose.file) == name_of(scan.file);
    return pose.id == scan.id && (pose.file.empty() || is_named);
  });
}

const ScanPose* pose_in_file(const std::vector<ScanPose>& file, const StationScan& scan,
                             const std::vector<StationScan>& scans) {
  const ScanPose* found = pose_in_file(file, scan);
  const bool is_of_another = found != nullptr && std::ranges::any_of(scans, [&](const StationScan& other) {
                               return other.id != scan.id &&
                                      claim_of(other, *found) <= claim_of(scan, *found) &&
                                      pose_in_file(file, other) == found;
                             });
  return is_of_another ? nullptr : found;
}

bool may_share_a_pose(const StationScan& scan) {
  const std::string own = own_name_of(scan);
  return scan.read_from.empty() || (!own.empty() && own != name_of(scan.file));
}

std::string lacks_pose(const std::filesystem::path& poses_file, const std::vector<ScanPose>& file,
                       const StationScan& scan) {
  const bool none = pose_in_file(file, scan) == nullptr;
  return poses_file.string() + " has no pose of it" +
         (none ? "" : ": the one of its name is another scan's, or may be");
}

std::unexpected<Error> no_pose_of_these(const std::filesystem::path& poses_file) {
  return bad_input(poses_file.string(), "no pose in it is of one of these scans",
                   "its `file` or `id` must name the scans");
}

namespace {

Result<std::vector<ScanPose>> read_either(const std::filesystem::path& poses_file, const std::string& unit,
                                          const std::filesystem::path& scans) {
  if (!is_conf(poses_file)) {
    return read_poses(poses_file);
  }
  Result<std::vector<ScanPose>> poses = read_conf_poses(poses_file, mm_per_unit(unit).value_or(1.0));
  if (!poses || !unit.empty()) {
    return poses;
  }
  const Result<double> theirs = mm_per_unit_of_scans(scans, *poses);
  return theirs ? read_conf_poses(poses_file, *theirs) : std::unexpected(theirs.error());
}

/// As who stitches them is told.
void warn_of_scale(const ScanSet& set, const std::vector<ScanPose>& poses,
                   const std::filesystem::path& poses_file) {
  PosesScale scale;
  for (const StationScan& scan : set.scans) {
    if (const ScanPose* pose = pose_of(poses, scan.id);
        pose != nullptr && pose->status == PoseStatus::kRegistered) {
      scale.add(*scan.grid, pose->model_from_scanner);
    }
  }
  if (const std::string fault = scale.fault(); !fault.empty()) {
    log_warning(poses_file.string() + ": " + fault);
  }
}

}  // namespace

Result<std::vector<ScanPose>> read_poses_file(const std::filesystem::path& poses_file,
                                              const std::string& unit, const std::filesystem::path& scans) {
  Result<std::vector<ScanPose>> poses = read_either(poses_file, unit, scans);
  const bool of_session = scans.empty() || SessionStore::is_session(scans);
  std::set<std::pair<std::string, int>> names;
  for (const ScanPose& pose : poses ? *poses : std::vector<ScanPose>{}) {
    const std::string name = pose.file.empty() ? "scan " + std::to_string(pose.id) : name_of(pose.file);
    // Those of a package are told apart by their files there, those of a session by their numbers.
    if (!names.insert({name, of_session ? pose.id : -1}).second && pose.packed_as.empty()) {
      return bad_input(poses_file.string(), "it has two poses of " + name, "leave the right one");
    }
  }
  return poses;
}

Result<std::vector<ScanPose>> poses_from_file(const ScanSet& set, const std::filesystem::path& poses_file,
                                              const std::string& unit) {
  const std::filesystem::path of =
      set.scans.empty() ? std::filesystem::path() : set.scans.front().read_from.parent_path();
  Result<std::vector<ScanPose>> read = read_poses_file(poses_file, unit, of);
  if (!read) {
    return std::unexpected(read.error());
  }
  if (!set.is_session()) {
    let_numbers_tell(set.scans, poses_file, &*read);
  }
  std::vector<ScanPose> poses;
  for (const StationScan& scan : set.scans) {
    const ScanPose* found = pose_in_file(*read, scan, set.scans);
    if (found != nullptr) {
      const bool counts = found->status == PoseStatus::kRegistered;
      const PlacedPrecision precision(*scan.grid);
      if (const Status near = counts ? precision.check(found->model_from_scanner, scan.file) : Status();
          !near) {
        return std::unexpected(near.error());
      }
      poses.push_back(*found);
      poses.back().id = scan.id;
      poses.back().file = scan.file;
      poses.back().packed_as.clear();
    } else {
      log_warning(scan.file + ": " + lacks_pose(poses_file, *read, scan));
    }
  }
  if (poses.empty()) {
    return no_pose_of_these(poses_file);
  }
  warn_of_scale(set, poses, poses_file);
  return poses;
}

bool all_judged(const ScanSet& set) {
  return std::ranges::all_of(set.scans,
                             [&](const StationScan& scan) { return pose_of(set.poses, scan.id) != nullptr; });
}

Result<std::vector<ScanPose>> poses_for(const ScanSet& set, const std::filesystem::path& poses_file,
                                        const std::string& unit, JobContext& job) {
  if (!poses_file.empty()) {
    return poses_from_file(set, poses_file, unit);
  }
  return all_judged(set) ? set.poses : register_scans(set, {}, job);
}

std::vector<PlacedScan> placed_scans(const ScanSet& set, const std::vector<ScanPose>& poses) {
  std::vector<PlacedScan> placed;
  for (const StationScan& scan : set.scans) {
    for (const ScanPose& pose : poses) {
      if (pose.id == scan.id && pose.status == PoseStatus::kRegistered) {
        placed.push_back(
            {scan.id, scan.grid.get(), scan.flags.get(), pose.model_from_scanner, pose.sigma_mm});
      }
    }
  }
  return placed;
}

}  // namespace dubsar
