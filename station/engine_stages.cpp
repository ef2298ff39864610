// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The threads behind the device: storing, registration, planning.
#include "planning/vain_scans.h"
#include "station/engine_impl.h"
#include "station/followed_word.h"
#include "station/session_pages.h"

namespace dubsar {

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
  const bool scans_on = !drives && !source->capabilities().finite;
  emit(ScanStored{id, grid.source, static_cast<std::int64_t>(grid.valid_count()), remark, scans_on});
  if (const Status noted = drive ? note_drive(id, *drive) : Status(); !noted) {
    give_up(noted.error());
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
      if (raw->kept) {
        raw->kept->leave();
      }
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

bool Engine::Impl::prepare_again(StationScan& scan) {
  const std::optional<PinSet> pins_now = known_pins();
  if (scan.said_tip_mm == (pins_now ? pins_now->tip_diameter_mm : 0.0)) {
    return true;
  }
  if (scan.stored.valid() && !scan.stored.get()) {
    return false;
  }
  Result<RangeGrid> grid = store->load_grid(scan.id);  // as it came
  if (!grid) {
    emit(Notice{grid.error().line()});
    return true;
  }
  StationScan anew = prepare_scan(scan.id, std::move(*grid), pins_now);
  anew.drive = scan.drive;
  scan = std::move(anew);
  return true;
}

void Engine::Impl::register_all(JobContext& job) {
  const auto handle = [&](StationScan scan, bool plan_now, bool is_resumed) {
    // The operator may have taken it out, and put it back, while it waited here: it is on disk before.
    if (!is_resumed && (taken_out.contains(scan.id) || names.contains(scan.id))) {
      queues->to_plan.push({std::nullopt, named_poses(), plan_now, true, false});
      return;
    }
    if (!is_resumed && !prepare_again(scan)) {
      return;  // it is lost; the run ends
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
    note_retakes(*item, item->view_of && drives ? step_again(*item->view_of) : std::nullopt);
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
    if (drives && item->device_waits) {
      const bool fresh = item->scan && !item->resumed;
      NextStep step = fresh ? step_after(item->scan->id, item->poses, *red_map, job) : step_to(*red_map);
      if (in_vain.empty() && !(step && step->again)) {  // else what came is seen to first
        step = retake_or(std::move(step), *item);
      }
      {
        const std::scoped_lock lock(mutex);
        changed_step.reset();
      }
      queues->to_device.push(std::move(step));
    } else if (drives && options.paced) {
      NextStep step = retake_or(step_to(*red_map), *item);
      const std::scoped_lock lock(mutex);
      changed_step = std::move(step);
    } else if (!drives && options.paced && !source->capabilities().finite) {
      end_conclusive(*red_map, *item);
    }
    item->thought.reset();
    const std::optional<ViewGain>& gain = planning.last_gain();
    if (vain.after(*red_map, gain ? gain->predicted_mm2 : std::nullopt, gain ? gain->actual_mm2 : 0.0)) {
      emit(
          Notice{"three scans brought next to nothing of what is red: stop, look at it, or sign with "
                 "--incomplete REASON"});
    }
    emit(RedMapChanged{std::move(*red_map), gain});
    // Last: the red map waits for no mesh, and the next scan is under way meanwhile.
    if (const Status stitched = planning.stitch(job); !stitched) {
      give_up(stitched.error());
    }
    show_model(job);
  }
  queues->to_device.close();
}

}  // namespace dubsar
