// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The thread that has the device: what it takes of it, and what comes before a scan.
#include "core/number_text.h"
#include "station/engine_impl.h"

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

void Engine::Impl::tell_start(const NextStep& step) const {
  if (step && !step->again) {
    emit(NextPlacement{step->view});
  } else if (drives || !source->capabilities().finite) {  // what was recorded moves nothing
    emit(DeviceStarts{});
  }
}

/// `step` is where the scan before this round said to go next; nothing in the first round.
void Engine::Impl::acquire(NextStep step, JobContext& job) {
  take_scans(std::move(step), job);
  end_halted();
  stop_motion_after_trouble(job);
  const std::optional<Error> error = [&] {
    const std::scoped_lock lock(mutex);
    takes_scans = false;
    return device_error;
  }();
  emit(DeviceRests{error});
  change_settings();  // what was asked for during the last scan
  queues->to_store.close();
}

void Engine::Impl::take_scans(NextStep step, JobContext& job) {
  // A device without an end, and nobody to ask for the next placement, gives one scan.
  const bool endless = !source->capabilities().finite && !drives;
  const int limit = options.max_scans > 0       ? options.max_scans
                    : endless && !options.paced ? stored_count + 1
                                                : 0;
  // A session that goes on begins with a scan of how the tablet lies now, unless it is conclusive already.
  if (wait_for_plan) {
    const std::optional<NextStep> planned = queues->to_device.pop();
    if (!planned || !(*planned || begins_again)) {
      return;
    }
  }
  if (drives && !step && !options.paced) {
    tell_start(step);
    if (!move_to_start(job)) {
      return;
    }
  }
  for (int taken = stored_count; limit == 0 || taken < limit;) {
    if (job.cancelled()) {
      give_up(stopped());
      break;
    }
    if (!wait_for_operator(step, job)) {
      break;
    }
    tell_start(step);
    change_settings();
    if (drives && !step && options.paced && !std::exchange(at_start, true) && !move_to_start(job)) {
      break;
    }
    if (step && !step->again && !move_to(*step->view.placement, step->scene, job)) {
      break;
    }
    const Taken got = take_scan(drives ? present : std::nullopt, job);
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
}

}  // namespace dubsar
