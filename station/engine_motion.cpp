// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What moves. Every placement is held against limits and keep-out volume, the whole way there, before the
// first motor is asked; after anything that went wrong none is asked again.
#include "station/engine_impl.h"

#include "planning/motor_placements.h"

namespace dubsar {

Status Engine::Impl::limit_rig() {
  const std::string where = options.limits ? options.limits_file : options.device;
  if (options.limits) {
    if (!rig) {
      return fail(ErrorKind::kUsage, "this device tells of no rig whose limits could be narrowed", where,
                  "leave the rig file out");
    }
    Result<Rig> narrow = narrowed(*rig, *options.limits, where);
    if (!narrow) {
      return std::unexpected(narrow.error());
    }
    rig = std::move(*narrow);
  }
  if (drives && rig) {
    const Result<Placement> first = first_placement(*rig, unseen(), where);
    if (!first) {
      return std::unexpected(first.error());
    }
  }
  return {};
}

void Engine::Impl::end_motion(Error error) {
  emit(Notice{error.line()});
  const std::scoped_lock lock(mutex);
  if (!device_error) {
    device_error = std::move(error);
  }
}

void Engine::Impl::end_halted() {
  if (!source->halted()) {
    return;
  }
  [[maybe_unused]] const Status said = source->stop();  // halted() knows
  const std::optional<Error> halt = source->halted();
  const bool told = [&] {
    const std::scoped_lock lock(mutex);
    return device_error.has_value();
  }();
  if (halt && !told) {
    end_motion(*halt);
  }
}

void Engine::halt() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->halt_asked = true;
  if (impl_->source) {
    impl_->source->halt();
  }
}

void Engine::Impl::stop_motion_after_trouble(const JobContext& job) {
  const bool failed_device = [&] {
    const std::scoped_lock lock(mutex);
    return device_error.has_value();
  }();
  if (!failed_device && !job.cancelled()) {
    return;
  }
  const Status still = source->stop();
  const bool told = [&] {
    const std::scoped_lock lock(mutex);
    // A second answer may be in other words; what is to be done by hand is the same.
    return still || (device_error && device_error->mend == still.error().mend);
  }();
  if (!told) {
    end_motion(still.error());
  }
}

StageScene Engine::Impl::unseen() const {
  constexpr double kPinRoomMm = 40;
  StageScene out = unseen_tablet(*rig, options.size_mm);
  if (known_pins()) {
    out.tablet_mm.min().array() -= kPinRoomMm;
    out.tablet_mm.max().array() += kPinRoomMm;
  }
  return out;
}

bool Engine::Impl::move_to_start(JobContext& job) {
  scene = rig ? unseen() : StageScene{};
  if (!rig) {
    present = present.value_or(Placement{});
    return true;
  }
  const Result<Placement> first = first_placement(*rig, scene, options.device);
  if (!first) {
    end_motion(first.error());
    return false;
  }
  // Turntable and tilt stand at 0 when the device was opened; where an arm stands only its driver knows.
  if (!rig->robot && !present) {
    present = Placement{};
  }
  const bool there = present && !first->free_pose && present->turntable_rad == first->turntable_rad &&
                     present->tilt_rad == first->tilt_rad;
  return there || move_to(*first, scene, job);
}

bool Engine::Impl::move_to(const Placement& target, const StageScene& on_stage, JobContext& job) {
  const auto refused = [&](Error error) {
    if (error.kind == ErrorKind::kCancelled) {
      give_up(stopped());
      return false;
    }
    error.kind = ErrorKind::kDevice;
    end_motion(std::move(error));
    return false;
  };
  Result<std::vector<Placement>> way = std::vector<Placement>{target};
  if (rig) {
    way = safe_way(*rig, on_stage, present, target, options.device);
  }
  if (!way) {
    way.error().what = "not driven (" + say_placement(*rig, target) + "): " + way.error().what;
    way.error().mend = "lay the tablet elsewhere or allow the rig more, then give the same command again";
    return refused(way.error());
  }
  for (Placement& stop : *way) {
    const Status placed = source->place(stop, job);
    if (job.cancelled() || !placed) {
      [[maybe_unused]] const Status still = source->stop();
      return refused(placed ? stopped() : placed.error());
    }
    stop.hand_turn.reset();
    present = stop;
  }
  scene = on_stage;
  return true;
}

NextStep Engine::Impl::step_again(int id) const {
  const std::optional<NextView> view = rig ? planning.same_view(*rig, id) : std::nullopt;
  // The scan that goes may be the one that tells how the tablet lies: room for whatever way it does.
  return view ? NextStep(Step{.view = *view, .scene = unseen(), .again = false, .retakes = id})
              : std::nullopt;
}

void Engine::Impl::note_retakes(const ScanToPlan& item, const NextStep& as_before) {
  const std::scoped_lock lock(mutex);
  std::erase_if(to_take_again, [&](int id) {  // one that was put back, or is asked for once more
    return item.view_of == id || std::ranges::find(item.poses, id, &ScanPose::id) != item.poses.end();
  });
  if (item.view_of && (!drives || as_before)) {
    to_take_again.push_back(*item.view_of);
    asked_again = as_before;
  }
}

NextStep Engine::Impl::retake_or(NextStep step, const ScanToPlan& item) {
  int id = -1;
  {
    const std::scoped_lock lock(mutex);
    id = device_error || to_take_again.empty() ? -1 : to_take_again.back();
  }
  if (id < 0) {
    return step;
  }
  // For a scan that has come since, the tablet may have been laid otherwise.
  if (item.device_waits || !asked_again || asked_again->retakes != id) {
    asked_again = step_again(id);
  }
  return asked_again ? asked_again : step;
}

void Engine::Impl::begin_retake(const NextStep& step) {
  if (drives) {
    std::erase(to_take_again, step ? step->retakes : -1);
  } else if (!to_take_again.empty()) {
    to_take_again.pop_back();
  }
}

NextStep Engine::Impl::step_to(const RedMap& red_map) const {
  if (red_map.conclusive || red_map.next.empty() || !red_map.next.front().placement) {
    return std::nullopt;
  }
  NextStep step;
  const bool is_known = planning.knows_how_it_lies();
  for (const NextView& view : red_map.next) {
    if (!view.placement) {
      continue;
    }
    StageScene on_stage;
    if (rig) {  // of one that was laid otherwise since, whatever way it lies
      on_stage =
          is_known ? planning.scene_for(*rig, *view.placement).value_or(StageScene{}) : unseen_and(view);
    }
    Step one{.view = view, .scene = on_stage, .again = false};
    if (!rig || check_clear(*rig, one.scene, *view.placement, options.device)) {
      if (const auto side = rig ? planning.before_lifting(*rig, view) : std::nullopt) {
        one.view = *side;
        one.scene =
            is_known ? planning.scene_for(*rig, *side->placement).value_or(one.scene) : unseen_and(*side);
      }
      return one;
    }
    step = step ? step : NextStep(one);  // refused, with its reason, by whoever is to drive there
  }
  return step;
}

Status Engine::Impl::note_drive(int id, const Placement& drive) {
  {
    const std::scoped_lock lock(mutex);
    drives_of_scans[id] = drive;
  }
  return store->save_document("drives", drives_to_json(drives_of_scans));
}

}  // namespace dubsar
