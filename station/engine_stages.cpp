// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/number_text.h"
#include "planning/vain_scans.h"
#include "station/engine_impl.h"
#include "station/followed_word.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

std::string remark_of(const ScanRecord& record) {
  std::vector<std::string> all = record.remarks;
  if (std::string losses = losses_of(record); !losses.empty()) {
    all.push_back(std::move(losses));
  }
  return fmt::format("{}", fmt::join(all, "; "));
}

}  // namespace

void Engine::Impl::keep_half(const std::optional<Placement>& drive, std::shared_ptr<UnfinishedScan> kept) {
  std::optional<RangeGrid> half = source->take_partial();
  if (!half || half->valid_count() == 0) {
    return;
  }
  emit(Notice{fmt::format("the half scan is kept, rows: {}", half->rows)});
  if (half->nominal) {
    half->nominal->placement += placement_offset;
  }
  hand_to_store({std::move(*half), std::nullopt, drive, std::move(kept), remark_of(source->record())});
}

/// Another scan of a name that is there is stored and said: what was measured is not dropped for its name.
bool Engine::Impl::is_known(const RangeGrid& grid) {
  if (grid.valid_count() == 0) {
    return false;
  }
  const KnownAs known = known_files.find(grid, [this](int id) { return store->load_grid(id); });
  if (known.kind == KnownAs::Kind::kNamesake) {
    emit(Notice{Error{ErrorKind::kBadInput,
                      "the session has another scan of this name: this is stored as one more", grid.source,
                      "take the other one out if this is to take its place"}
                    .line()});
  }
  if (known.kind == KnownAs::Kind::kOtherUnit && !std::exchange(told_unit, true)) {
    const bool is_smaller = known.smaller_by >= 1;
    Error other{ErrorKind::kBadInput,
                "the session has this scan in another unit, " +
                    short_text(is_smaller ? known.smaller_by : 1 / known.smaller_by) +
                    (is_smaller ? " times smaller: it is left out, and so are all others of which that holds"
                                : " times larger: it is left out, and so are all others of which that holds"),
                grid.source, "begin a new session in the right unit, or take those scans out of this one"};
    emit(Notice{other.line()});
    const std::scoped_lock lock(mutex);
    device_error = device_error ? device_error : std::move(other);
  }
  keep_pins_of(known.kind);
  return known.kind == KnownAs::Kind::kSame || known.kind == KnownAs::Kind::kOtherUnit;
}

bool Engine::Impl::hand_to_store(RawScan scan) {
  const std::shared_ptr<UnfinishedScan> kept = scan.kept;
  if (kept) {
    kept->remark(scan.remark);  // a device may make it after its last row
  }
  const bool taken = queues->to_store.push(std::move(scan));
  if (!taken && kept) {
    kept->leave();  // the disk has refused one before it
  }
  return taken;
}

/// Takes the next scan of the device. kEnd when there is none, or the run is over; kNothing when this one
/// does not count, but others may follow.
Taken Engine::Impl::take_scan(const std::optional<Placement>& drive, JobContext& job) {
  std::optional<SparseFlagger> flagger;
  SampleFlags flags;
  // What comes from files is there anyway.
  const std::shared_ptr<UnfinishedScan> kept =
      source->capabilities().finite ? nullptr : std::make_shared<UnfinishedScan>(store->folder(), drive);
  const auto on_profile = [&](const RangeGrid& grid, int row) {
    if (kept) {
      kept->remark(remark_of(source->record()));
      kept->follow(grid, placement_offset);
    }
    if (!flagger && grid.spacing_mm > 0) {
      flagger.emplace(grid.cols, grid.spacing_mm);
    }
    if (flagger) {
      flagger->update(grid, flags);
    }
    emit(ProfileArrived{row, &grid, &flags});
  };
  Result<std::optional<RangeGrid>> grid = [&] {
    const StageClock timing = clock("acquisition");
    return source->next(on_profile, job);
  }();
  if (!grid && grid.error().kind != ErrorKind::kCancelled) {
    {
      const std::scoped_lock lock(mutex);
      device_error = device_error ? device_error : grid.error();
    }
    emit(Notice{grid.error().line()});
    keep_half(drive, kept);
    // A bad file of a folder does not stop the others.
    const bool others = source->capabilities().finite && grid.error().kind == ErrorKind::kBadInput;
    return others ? Taken::kNothing : Taken::kEnd;
  }
  if (!grid) {
    // Who stopped the scan did not like it; who shut the window had something else to do. A file of a finite
    // source would never be read to its end if its half were stored.
    const bool keeps = [&] {
      const std::scoped_lock lock(mutex);
      return keeps_half && !source->capabilities().finite;
    }();
    if (keeps) {
      keep_half(drive, kept);
    }
    give_up(grid.error());
    return Taken::kEnd;
  }
  if (!*grid) {
    return Taken::kEnd;
  }
  if (is_known(**grid)) {
    return Taken::kNothing;
  }
  if ((*grid)->valid_count() == 0) {
    return refuse_empty();
  }
  empty_scans = 0;
  if (flagger) {
    flagger->finish(**grid, flags);
  }
  if ((*grid)->nominal) {
    (*grid)->nominal->placement += placement_offset;
  }
  const bool streamed = flagger.has_value() && flags.size() == (*grid)->size();
  const bool taken =
      hand_to_store({std::move(**grid), streamed ? std::optional(std::move(flags)) : std::nullopt, drive,
                     kept, remark_of(source->record())});
  return taken ? Taken::kScan : Taken::kEnd;
}

/// `step` is where the scan before this round said to go next; nothing in the first round.
void Engine::Impl::acquire(NextStep step, JobContext& job) {
  // A device without an end, and nobody to ask for the next placement, gives one scan.
  const bool endless = !source->capabilities().finite && !drives;
  const int limit = options.max_scans > 0       ? options.max_scans
                    : endless && !options.paced ? stored_count + 1
                                                : 0;
  // A session that goes on begins with a scan of how the tablet lies now, unless it is conclusive already.
  if (wait_for_plan) {
    const std::optional<NextStep> planned = queues->to_device.pop();
    if (!planned || !(*planned || begins_again)) {
      queues->to_store.close();
      return;
    }
  }
  if (drives && !step && !options.paced && !move_to_start(job)) {
    queues->to_store.close();
    return;
  }
  for (int taken = stored_count; limit == 0 || taken < limit;) {
    if (job.cancelled()) {
      give_up(stopped());
      break;
    }
    if (!wait_for_operator(step, job)) {
      break;
    }
    change_settings();
    if (drives && !step && options.paced && !std::exchange(at_start, true) && !move_to_start(job)) {
      break;
    }
    if (step && !step->again) {
      emit(NextPlacement{step->view});
      if (!move_to(*step->view.placement, step->scene, job)) {
        break;
      }
    }
    const Taken got = take_scan(drives ? present : std::nullopt, job);
    end_scanning();
    if (got == Taken::kEnd) {
      break;
    }
    if (drives && got == Taken::kNothing) {
      step.reset();  // the same view once more
      continue;
    }
    taken += got == Taken::kScan ? 1 : 0;
    if (drives) {
      step = queues->to_device.pop().value_or(std::nullopt);
      if (!step) {
        break;
      }
    }
  }
  end_halted();
  stop_motion_after_trouble(job);
  change_settings();  // what was asked for during the last scan
  queues->to_store.close();
}

bool Engine::Impl::store_scan(int id, const RangeGrid& grid, const std::optional<Placement>& drive,
                              const std::string& remark) {
  const StageClock timing = clock("storing");
  if (const Status taken = take_pages_back_once(*store, fmt::format("scan {} has come", id), kPlan); !taken) {
    emit(Notice{taken.error().line()});
  }
  const Result<int> stored = store->add_grid(grid, remark);
  if (!stored) {
    give_up(stored.error());
    return false;
  }
  if (*stored != id) {
    give_up({ErrorKind::kInternal, "a scan was stored under another number than it was promised", {}, {}});
    return false;
  }
  {
    const std::scoped_lock lock(mutex);
    ++stored_count;
  }
  emit(ScanStored{id, grid.source, static_cast<std::int64_t>(grid.valid_count()), remark});
  if (drive) {
    note_drive(id, *drive);
  }
  keep_origin();
  return true;
}

/// Each scan goes to registration while it is being stored; what registration finds of it waits until it is
/// on disk.
void Engine::Impl::keep_stored() {
  while (std::optional<RawScan> raw = queues->to_store.pop()) {
    const Result<int> id = store->next_id();
    if (!id) {
      give_up(id.error());
      continue;
    }
    // What is stored is what came: a spacing or a pin size that is filled in is not part of it.
    const std::optional<PinSet> pins_now = known_pins();
    const bool filled_in = raw->grid.spacing_mm <= 0 || (pins_now && raw->grid.pin_tip_diameter_mm <= 0);
    const std::optional<RangeGrid> as_it_came = filled_in ? std::optional(raw->grid) : std::nullopt;
    StationScan scan = prepare_scan(*id, std::move(raw->grid), pins_now, std::move(raw->flags));
    scan.drive = raw->drive;
    tell_misplaced_pins(scan);
    std::promise<bool> outcome;
    scan.stored = outcome.get_future().share();
    // Where registration is behind, the disk does not wait for it.
    const bool handed_on = queues->to_register.try_push(scan);
    const bool stored = store_scan(*id, as_it_came ? *as_it_came : *scan.measured, scan.drive, raw->remark);
    if (!stored && raw->kept) {
      raw->kept->leave();
    }
    outcome.set_value(stored);
    if (stored && !handed_on) {
      queues->to_register.push(std::move(scan));
    }
  }
  queues->to_register.close();
}

ScanPose Engine::Impl::register_scan(const StationScan& scan, JobContext& job) {
  const StageClock timing = clock("registration");
  const std::optional<PinSet> pins_now = known_pins();
  const PinSet* said = pins_now ? &*pins_now : nullptr;
  precision.insert_or_assign(scan.id, PlacedPrecision(*scan.grid));
  const auto locked = word.locked.find(scan.id);
  return judged(
      locked != word.locked.end() && locked->second.frame == lock_frame
          ? registrar.add_at(scan.id, scan.measured, said, locked->second.model_from_scanner, true, job)
          : registrar.add(scan.id, scan.measured, said, job));
}

void Engine::Impl::register_all(JobContext& job) {
  const auto handle = [&](StationScan scan, bool plan_now, bool is_resumed) {
    // The operator may have taken it out, and put it back, while it waited here: it is on disk before.
    if (!is_resumed && (taken_out.contains(scan.id) || names.contains(scan.id))) {
      queues->to_plan.push({std::nullopt, named_poses(), plan_now, true, false});
      return;
    }
    names[scan.id] = scan.file;
    ScanPose pose = register_scan(scan, job);
    if (scan.stored.valid() && !scan.stored.get()) {
      registrar.remove(scan.id, job);  // it is lost; the run ends, and nothing that is saved may speak of it
      names.erase(scan.id);
      return;
    }
    std::vector<SetAside> aside;
    pose = set_intruders_aside(scan, std::move(pose), aside, job);
    pose.file = scan.file;
    if (is_resumed && plan_now) {
      hold_locks(job);
    }
    std::vector<ScanPose> poses = named_poses();
    // Whatever ends the run, what it found until now is in the session.
    if (plan_now && !job.cancelled()) {
      if (const Status saved = save_followed_poses(*store, poses); !saved) {
        give_up(saved.error());
      }
    }
    {
      const std::scoped_lock lock(mutex);
      last_scan_taken_up = pose.status == PoseStatus::kRegistered;
    }
    emit(ScanPlaced{pose, poses, scan.measured, scan.grid, scan.flags, std::move(aside)});
    queues->to_plan.push({std::move(scan), std::move(poses), plan_now, true, is_resumed});
  };
  for (std::size_t k = 0; k < resumed.size() && !job.cancelled(); ++k) {
    handle(std::move(resumed[k]), k + 1 == resumed.size(), true);
  }
  resumed.clear();
  if (job.cancelled()) {
    give_up(stopped());
  }
  while (std::optional<ToRegister> item = queues->to_register.pop()) {
    if (job.cancelled()) {
      give_up(stopped());
      continue;
    }
    obey_commands(job);
    if (auto* scan = std::get_if<StationScan>(&*item)) {
      handle(std::move(*scan), true, false);
    }
  }
  if (!job.cancelled()) {
    obey_commands(job);
  }
  queues->to_plan.close();
}

void Engine::Impl::plan_all(JobContext& job) {
  VainScans vain;
  while (std::optional<ScanToPlan> item = queues->to_plan.pop()) {
    if (item->scan) {
      planning.add(*item->scan);
      if (item->scan->grid->nominal) {
        lies_as[item->scan->id] = item->scan->grid->nominal->placement;
      }
    }
    if (job.cancelled()) {
      give_up(stopped());  // the device waits for a next step that will not come
    }
    if (item->resumed) {
      for (const ScanPose& pose : item->poses) {
        if (pose.status == PoseStatus::kRegistered) {
          taken_up.insert(pose.id);
        }
      }
    }
    if (failed() || !item->plan_now) {
      continue;
    }
    const StageClock timing = clock("planning and meshing");
    // While it is known where the scan lies that was taken out.
    const NextStep as_before = item->view_of && drives ? step_again(*item->view_of) : std::nullopt;
    if (const Status placed = planning.place(item->poses, false, job); !placed) {
      give_up(placed.error());
      continue;
    }
    tell_foreign();
    Result<RedMap> red_map = planning.red_map(rig ? &*rig : nullptr, job);
    if (!red_map) {
      give_up(red_map.error());
      continue;
    }
    bool ends = red_map->conclusive;
    if (drives && item->device_waits) {
      const bool fresh = item->scan && !item->resumed;
      NextStep step = fresh ? step_after(item->scan->id, item->poses, *red_map, job) : step_to(*red_map);
      {
        const std::scoped_lock lock(mutex);
        changed_step.reset();
      }
      queues->to_device.push(std::move(step));
    } else if (drives && options.paced) {
      const std::scoped_lock lock(mutex);
      changed_step = as_before ? as_before : step_to(*red_map);
      ends = ends && !scanning;
    } else if (!drives && options.paced && !source->capabilities().finite) {
      ends = end_conclusive(*red_map, *item);
    }
    item->thought.reset();
    const std::optional<ViewGain>& gain = planning.last_gain();
    if (vain.after(*red_map, gain ? gain->predicted_mm2 : std::nullopt, gain ? gain->actual_mm2 : 0.0)) {
      emit(
          Notice{"three scans brought next to nothing of what is red: stop, look at it, or sign with "
                 "--incomplete REASON"});
    }
    emit(RedMapChanged{std::move(*red_map), gain, ends});
    // Last: the red map waits for no mesh, and the next scan is under way meanwhile.
    if (const Status stitched = planning.stitch(job); !stitched) {
      give_up(stitched.error());
    }
    show_model(job);
  }
  queues->to_device.close();
}

}  // namespace dubsar
