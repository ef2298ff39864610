// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session's folder holds, for a skin to show before any device is there.
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "acquisition/device_uri.h"
#include "acquisition/operator_log.h"
#include "acquisition/sign_off_log.h"
#include "core/tablet_frame.h"
#include "formats/checklist_json.h"
#include "formats/mesh_io.h"
#include "formats/red_map_json.h"
#include "station/live_session.h"
#include "station/packing.h"
#include "station/plan_again.h"
#include "station/results.h"
#include "station/session_drives.h"
#include "station/session_faults.h"
#include "station/session_pins.h"
#include "station/session_scans.h"
#include "station/told_session.h"
#include "station/unfinished_scan.h"

namespace dubsar {

namespace {

/// A scan that was stored or taken out since does not count in it yet, or still does.
bool is_of_the_same_scans(const RedMap& map, const std::vector<ScanPose>& poses) {
  std::set<int> mapped;
  for (const RedScan& scan : map.scans) {
    mapped.insert(scan.id);
  }
  for (const ScanCopy& copy : map.copies) {
    mapped.insert(copy.id);
  }
  std::set<int> registered;
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      registered.insert(pose.id);
    }
  }
  return mapped == registered;
}

/// Or the session knows of none.
bool is_own_device(const SessionStore& store, const std::string& device) {
  const std::string own = own_device(store).value_or(std::string());
  return own.empty() || own == absolute_device(device);
}

bool is_stored(const SessionStore& store, const RedMap& map) {
  const auto differs = differs_from_stored(store, map);
  return differs && *differs && (*differs)->empty();
}

}  // namespace

void LiveSession::take_own_device(const SessionStore& store) {
  const Result<std::string> own = own_device(store);
  const std::scoped_lock lock(mutex_);
  if (!options_.is_device_asked && own && !own->empty()) {
    options_.device = *own;
  }
}

Result<SessionStore> LiveSession::open_to_look() {
  Result<SessionStore> store = SessionStore::open(options_.session, SessionStore::Access::kReadOnly,
                                                  SessionStore::OnDamage::kRebuild, &looking_);
  const std::scoped_lock lock(mutex_);
  state_.stage.clear();  // what follows has none of its own
  return store;
}

void LiveSession::read_folder() {
  if (!SessionStore::is_session(options_.session)) {
    look_after_rig();
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    state_.exists = true;
    state_.phase = LivePhase::kReading;
  }
  changed();
  const Result<SessionStore> store = open_to_look();
  if (store) {
    take_own_device(*store);
  }
  look_after_rig();
  const auto scans = store ? store->scans() : std::unexpected(store.error());
  const auto poses = store ? standing_poses(*store) : std::unexpected(store.error());
  if (!scans || !poses) {
    end(std::unexpected(!scans ? scans.error() : poses.error()));
    return;
  }
  // How the tablet lies now says the drive of the last scan.
  const std::map<int, Placement> drives = session_drives(*store).value_or(std::map<int, Placement>());
  const Result<std::optional<PinSet>> stored_pins = session_pins(*store);
  const std::optional<PinSet> pins = stored_pins && *stored_pins ? *stored_pins : options_.pins;
  {
    const std::scoped_lock lock(mutex_);
    if (pins) {
      state_.pins = std::make_shared<const PinSet>(*pins);
    }
    if (!stored_pins) {
      state_.notice = stored_pins.error().line();
    }
    show_scans(*store, *scans);
    follow(*poses);
    state_.is_driven = !drives.empty() && is_own_device(*store, options_.device);
    state_.record = tablet_record_of(*store);
    if (Result<SettingWords> kept = kept_settings(*store, options_.device)) {
      settings_ = std::move(*kept);
    }
  }
  look_for_broken_off();
  show_verdict(*store);
  changed();
  const bool has_model = show_stored_model(*store, *poses);
  bool is_kept = false;   // else a scan was taken out since, or moved: the verdict is worked out anew
  bool is_shown = false;  // the mesh says what is sparse, not what of it is excused
  {
    const std::scoped_lock lock(mutex_);
    is_kept = has_model && state_.red_map && is_of_the_same_scans(*state_.red_map, *poses);
    is_shown = is_kept && state_.red_map->conclusive;
    state_.verdict_kept = is_kept;
  }
  ScanSet set;
  for (const StoredScan& stored : *scans) {
    if (job_->cancelled() || stored.damaged) {
      continue;
    }
    if (const auto grid = store->load_grid(stored.id)) {
      StationScan scan = prepare_scan(stored.id, *grid, pins);
      show_grid(stored.id, *scan.measured, *scan.grid, *scan.flags);
      if (const auto drive = drives.find(stored.id); drive != drives.end()) {
        scan.drive = drive->second;
      }
      if (!is_shown && !stored.dropped) {
        set.scans.push_back(std::move(scan));
      }
    }
  }
  if (!set.scans.empty() && !job_->cancelled()) {
    if (Result<std::optional<Rig>> rig = session_rig(*store)) {
      set.rig = std::move(*rig);
    }
    rebuild_model(*store, set, *poses, is_kept);
  }
}

void LiveSession::look_for_broken_off() {
  int rows = 0;
  for (const LeftScan& left : left_scans(options_.session)) {
    rows += left.rows();
  }
  const std::scoped_lock lock(mutex_);
  state_.broken_off_rows = rows;
}

void LiveSession::show_scans(const SessionStore& store, const std::vector<StoredScan>& scans) {
  // What is first told weighs most: the database, before the grids.
  if (const std::vector<std::string> told = told_of_opening(store); !told.empty()) {
    state_.notice = told.front();
  }
  for (const StoredScan& stored : scans) {
    LiveScan& scan = scan_of(stored.id);
    scan.file = stored.source;
    scan.samples = stored.samples;
    scan.dropped = stored.dropped;
    scan.damaged = stored.damaged;
    scan.note = stored.note;
    scan.remark = stored.remark;
  }
  show_faults(store, scans);
  show_hints(store);
}

void LiveSession::note_last_scan(const SessionStore& store) {
  const std::map<int, std::string> times = stored_times(store);
  last_scan_ = times.empty() ? std::string() : times.rbegin()->second;
}

void LiveSession::show_verdict(const SessionStore& store) {
  if (const auto text = store.load_document("red_map"); text && *text) {
    if (auto map = parse_red_map(**text, "red map of the session")) {
      const std::scoped_lock lock(mutex_);
      state_.red_map = std::make_shared<const RedMap>(std::move(*map));
    }
  }
  show_checklist(store);
  show_sign_offs(store);
}

void LiveSession::show_checklist(const SessionStore& store) {
  if (const auto text = store.load_document("checklist"); text && *text) {
    if (auto list = parse_checklist(**text, "checklist of the session")) {
      list->disk_free_gib = store.disk_free_gib();  // there is to be room for what comes now
      const std::scoped_lock lock(mutex_);
      state_.checklist = std::move(*list);
    }
  }
}

void LiveSession::show_sign_offs(const SessionStore& store) {
  const auto signed_offs = read_sign_offs(store, *job_);
  if (signed_offs && !signed_offs->sign_offs.empty()) {
    const std::scoped_lock lock(mutex_);
    show_signature(signed_offs->sign_offs.back());
  }
}

void LiveSession::show_faults(const SessionStore& store, const std::vector<StoredScan>& scans) {
  note_last_scan(store);
  state_.lost_records = lost_records(store);
  state_.damage_found = !store.opening().damage.empty();
  for (const StoredScan& stored : scans) {
    LiveScan& scan = scan_of(stored.id);
    scan.damaged = stored.damaged;
    scan.fault = damage_of(store, stored);
    scan.record_lost = may_have_been_taken_out(stored);
    if (scan.remark.empty()) {
      scan.remark = stored.remark;
    }
  }
}

void LiveSession::show_signature(const CheckedSignOff& latest) {
  const bool holds = latest.holds();
  state_.signed_off = holds;
  state_.signed_by = holds ? latest.sign_off.name : std::string();
  state_.void_signed_by = holds ? std::string() : latest.sign_off.name;
  state_.void_since = holds ? std::string() : latest.changed.front();
}

bool LiveSession::show_stored_model(const SessionStore& store, const std::vector<ScanPose>& poses) {
  std::optional<Mesh> mesh = stored_mesh(store, poses, *job_);
  const bool is_of_these_poses = mesh.has_value();
  if (!mesh) {  // one of other poses is better than none until there is a better one
    if (Result<Mesh> older = read_mesh(store.mesh_folder() / "model.ply")) {
      mesh = std::move(*older);
    }
  }
  if (mesh && !job_->cancelled()) {
    const RigidTransform tablet_from_model = tablet_frame(*mesh);
    show_model(std::make_shared<const Mesh>(std::move(*mesh)), nullptr, tablet_from_model);
    changed();
  }
  return is_of_these_poses;
}

void LiveSession::verdict_after_break(const SessionStore& store) {
  const auto poses = standing_poses(store);
  const std::shared_ptr<const RedMap> map = state().red_map;
  const bool kept = poses && map && is_of_the_same_scans(*map, *poses) && is_stored(store, *map);
  if (kept) {
    show_checklist(store);
  }
  show_sign_offs(store);
  const std::scoped_lock lock(mutex_);
  state_.verdict_kept = kept;
}

bool LiveSession::begins_afterwards() {
  {
    const std::scoped_lock lock(mutex_);
    if (closing_) {
      return false;
    }
    if (job_->cancelled()) {
      job_ = new_job();
    }
    state_.phase = LivePhase::kReading;
    state_.reads_folder = true;
  }
  changed();
  return true;
}

std::shared_ptr<JobContext> LiveSession::begin_unasked() {
  auto job = new_job();
  {
    const std::scoped_lock lock(mutex_);
    if (closing_ || !later_.empty() || scan_later_ || next_) {
      return nullptr;
    }
    unasked_ = job;
    state_.reads_folder = false;
    state_.phase = LivePhase::kStill;  // what is asked for begins at once
  }
  changed();
  return job;
}

void LiveSession::look_for_package(const std::filesystem::path& at) {
  const std::filesystem::path package =
      at.empty() ? usual_package_of(std::filesystem::absolute(options_.session)) : at;
  std::error_code none;
  if (!std::filesystem::exists(package, none) || !state().signed_off) {
    return;
  }
  const auto job = begin_unasked();
  if (!job) {
    return;
  }
  const Result<bool> packed = is_packed(options_.session, package, *job);
  const std::scoped_lock lock(mutex_);
  if (packed && *packed && !record_later_) {  // else it is described otherwise since
    state_.package = package;
  }
}

void LiveSession::rebuild_model(const SessionStore& store, const ScanSet& set,
                                const std::vector<ScanPose>& poses, bool red_alone) {
  const auto job = begin_unasked();
  if (!job) {
    return;
  }
  if (red_alone) {
    const LiveState now = state();
    if (Result<ColouredPoints> red = red_points_again(set, poses, *now.mesh, *job)) {
      show_model(now.mesh, std::make_shared<const ColouredPoints>(std::move(*red)), now.tablet_from_model);
    }
    return;
  }
  const Result<PlannedAgain> planned = plan_again(set, poses, *job);
  if (planned && !planned->results.mesh.faces.empty()) {
    auto mesh = std::make_shared<const Mesh>(planned->results.mesh);
    auto red = std::make_shared<const ColouredPoints>(planned->stage->red_points(*mesh));
    show_model(mesh, std::move(red), planned->stage->tablet_from_model(*mesh));
  }
  const bool kept = planned && is_stored(store, planned->results.red_map);
  const std::scoped_lock lock(mutex_);
  if (planned) {
    follow(planned->results.poses);
    state_.red_map = std::make_shared<const RedMap>(planned->results.red_map);
    state_.verdict_kept = kept;
  }
}

}  // namespace dubsar
