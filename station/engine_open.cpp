// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_device.h"
#include "formats/atomic_file.h"
#include "formats/grid_header.h"
#include "station/engine_impl.h"
#include "station/pin_faults.h"
#include "station/session_pages.h"
#include "station/told_session.h"

namespace dubsar {

namespace {

/// A hand turn is a motion of its own: nobody's hands are at the tablet.
bool turns_its_own_tablet(const DeviceUri& device) {
  return device.scheme == "sim";
}

/// How the tablet lay for a scan that is not read: the operator may put it back. Where its file does not
/// tell, no more often than there were scans was the tablet lifted.
int placement_of(const SessionStore& store, const StoredScan& scan) {
  const std::filesystem::path path = store.folder() / scan.file;
  const Result<std::string> bytes =
      scan.damaged ? fail(ErrorKind::kBadInput, "damaged", path.string()) : read_whole_file(path);
  const Result<GridHeader> header =
      bytes ? decode_grid_header(*bytes, path.string()) : std::unexpected(bytes.error());
  if (!header) {
    return scan.id;
  }
  return header->grid.nominal ? header->grid.nominal->placement : -1;
}

}  // namespace

Status Engine::Impl::load_resumed(JobContext& job) {
  const auto stored = store->scans();
  if (!stored) {
    return std::unexpected(stored.error());
  }
  const bool is_of_files = source->capabilities().finite;
  for (const StoredScan& scan : *stored) {
    if (job.cancelled()) {
      return std::unexpected(stopped());
    }
    if (scan.dropped || scan.damaged) {
      // One that stands and is damaged is taken again from its file.
      if (is_of_files && scan.dropped) {
        known_files.add(scan, nullptr);
      }
      placement_offset = std::max(placement_offset, placement_of(*store, scan) + 1);
      continue;
    }
    job.progress("reading the session", static_cast<double>(scan.id) / static_cast<double>(stored->size()));
    Result<RangeGrid> grid = store->load_grid(scan.id);
    if (!grid) {
      emit(Notice{grid.error().line()});
      continue;
    }
    if (is_of_files) {
      known_files.add(scan, &*grid);
    }
    if (grid->nominal) {
      placement_offset = std::max(placement_offset, grid->nominal->placement + 1);
    }
    resumed.push_back(prepare_scan(scan.id, std::move(*grid), pins));
    tell_misplaced_pins(resumed.back());
    if (const auto drive = drives_of_scans.find(scan.id); drive != drives_of_scans.end()) {
      resumed.back().drive = drive->second;
    }
  }
  lock_frame = frame_of_locks(
      word.locked, [&](int id) { return std::ranges::find(resumed, id, &StationScan::id) != resumed.end(); });
  // What the operator has fixed comes first: the others are registered to it, and its frame is the model's.
  std::ranges::stable_partition(resumed, [&](const StationScan& scan) {
    const auto locked = word.locked.find(scan.id);
    return locked != word.locked.end() && locked->second.frame == lock_frame;
  });
  stored_count = static_cast<int>(resumed.size());
  return {};
}

void Engine::Impl::tell_misplaced_pins(const StationScan& scan) const {
  if (const auto fault =
          options.pins ? misplaced_tips(*options.pins, scan.id, *scan.measured, scan.file) : std::nullopt) {
    emit(Notice{fault->line()});
  }
}

bool Engine::Impl::is_among_newest(const RangeGrid& rows, std::size_t count) const {
  const auto stored = store->scans();
  for (std::size_t k = stored ? stored->size() : 0; k > 0 && count > 0; --k, --count) {
    const Result<RangeGrid> grid = store->load_grid((*stored)[k - 1].id);
    if (grid && holds(*grid, rows)) {
      return true;
    }
  }
  return false;
}

Status Engine::Impl::store_left_rows(const RangeGrid& rows, const LeftScan& left) {
  // A program may also end between the storing of a scan and the end of its copy here.
  if (rows.valid_count() == 0 || is_among_newest(rows, left.parts.size())) {
    return {};
  }
  if (const Status taken = take_pages_back_once(*store, "a scan has come", kPlan); !taken) {
    emit(Notice{taken.error().line()});
  }
  const Result<int> id = store->add_grid(rows, left.remark);
  if (!id) {
    return std::unexpected(id.error());
  }
  const Status noted = left.drive ? note_drive(*id, *left.drive) : Status();
  emit(ScanStored{*id, rows.source, static_cast<std::int64_t>(rows.valid_count()), left.remark, true});
  emit(Notice{
      fmt::format("a scan in whose middle the program ended is kept: {} rows, as scan {}", rows.rows, *id)});
  return noted ? keep_origin_of_left_rows() : noted;
}

void Engine::Impl::take_up_left_scans() {
  for (const LeftScan& left : left_scans(store->folder())) {
    for (const RangeGrid& rows : left.parts) {
      if (const Status kept = store_left_rows(rows, left); !kept) {
        emit(Notice{kept.error().line()});
        return;
      }
    }
    if (left.unread.empty()) {
      forget(left);
      continue;
    }
    for (const Error& damage : left.unread) {
      emit(Notice{"damaged: " + damage.line()});
    }
    const Result<std::filesystem::path> aside = set_aside(left);
    emit(Notice{aside ? "what can be read of that scan is stored; all of its files stay in " +
                            aside->lexically_relative(store->folder()).generic_string()
                      : aside.error().line()});
  }
}

Status Engine::Impl::open(JobContext& job) {
  // The device first: a wrong URI must not leave an empty session behind.
  const DriverRegistry registry;
  for (const Error& rejected : registry.rejected()) {
    emit(Notice{"driver left out: " + rejected.line()});
  }
  Result<RangeSource> opened = RangeSource::open(options.device, registry);
  if (!opened) {
    return std::unexpected(opened.error());
  }
  {
    const std::scoped_lock lock(mutex);
    source = std::move(*opened);
    if (halt_asked) {
      source->halt();
    }
  }
  rig = source->capabilities().rig;
  if (const auto reminder = verification_reminder(options.device)) {
    emit(Notice{*reminder});
  }
  drives = options.automatic && source->capabilities().can_place;
  const bool is_paced = options.paced;
  // Nothing moves, and no laser goes on, before somebody has said that the tablet is turned.
  waits_for_hands_alone = options.automatic && !is_paced && !turns_its_own_tablet(source->uri());
  options.paced = is_paced || waits_for_hands_alone;
  if (drives && options.max_scans <= 0 && !is_paced) {  // else who looks at the window says when it ends
    options.max_scans = kAutomaticScans;
  }
  if (const Status limited = limit_rig(); !limited) {
    return limited;
  }
  if (job.cancelled()) {  // nor must one that was stopped
    return std::unexpected(stopped());
  }
  Result<SessionStore> session =
      SessionStore::open_or_create(options.session, SessionStore::OnDamage::kRebuild, &job);
  if (!session) {
    return std::unexpected(session.error());
  }
  store = std::move(*session);
  for (const std::string& line : told_of_opening(*store)) {
    emit(Notice{line});
  }
  calibration = calibration_file_of(options.device);
  if (const Status set = open_settings(); !set) {
    return set;
  }
  if (Result<std::optional<PinSet>> known = session_pins(*store, options.pins)) {
    pins = std::move(*known);
  } else {
    emit(Notice{known.error().line()});
    pins = options.pins;
  }
  if (pins) {
    emit(PinsKnown{std::make_shared<const PinSet>(*pins)});
  }
  if (const auto text = store->load_document("drives"); text && *text) {
    if (auto known = parse_drives(**text, "drives of the session")) {
      drives_of_scans = std::move(*known);
    }
  }
  Result<OperatorLog> log = read_operator_log(*store);
  if (!log) {
    return std::unexpected(log.error());
  }
  for (const Error& damage : log->damage) {
    emit(Notice{"damaged: " + damage.line()});
  }
  word = std::move(log->word);
  for (const auto& [id, hint] : word.hints) {
    if (const Status given = registrar.set_hint(id, hint, job); !given) {
      emit(Notice{given.error().line()});
    }
  }
  take_up_left_scans();
  if (const Status loaded = load_resumed(job); !loaded) {
    return loaded;
  }
  wait_for_plan = drives && !resumed.empty();
  begins_again = std::ranges::any_of(options.first_commands, [](const OperatorCommand& command) {
    return std::holds_alternative<ScanAgain>(command);
  });
  is_open = true;
  return {};
}

}  // namespace dubsar
