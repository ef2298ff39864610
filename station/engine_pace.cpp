// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A paced run: somebody stands beside the scanner, who turns the tablet and says when it may be scanned.
#include "station/engine_impl.h"

namespace dubsar {

bool Engine::Impl::must_wait(const NextStep& step) const {
  if (!drives && source->capabilities().finite) {
    return false;  // what was recorded waits for nobody
  }
  if (!asked_once) {
    return options.first_scan_waits;
  }
  if (!drives) {
    return true;
  }
  const bool by_hand = step && step->view.placement && step->view.placement->hand_turn;
  const bool retakes = step && step->retakes >= 0;  // nothing moves because a scan was taken out
  return by_hand || retakes || !(last_scan_taken_up || waits_for_hands_alone);
}

std::shared_ptr<void> Engine::Impl::begin_thought() {
  ++thoughts;
  return {this, [](Impl* engine) {
            --engine->thoughts;
            engine->pace.notify_all();
          }};
}

bool Engine::Impl::wait_for_operator(NextStep& step, const JobContext& job) {
  if (!options.paced) {
    return true;
  }
  // Whatever ends the waiting, the camera is the scan's then.
  struct EndOfView {
    Engine::Impl& engine;
    ~EndOfView() { engine.end_view(); }
  } const end_of_view{*this};
  std::unique_lock lock(mutex);
  bool told = false;
  bool changed = false;
  for (;;) {
    if (finish_asked || first_error || job.cancelled() || source->halted()) {
      lock.unlock();
      if (job.cancelled()) {
        give_up(stopped());
      }
      return false;
    }
    // Of several commands only the last one's step is worth telling: a key for one before it would be lost.
    const bool settled = !thinks_over();
    if (settled && changed_step) {
      step = *std::exchange(changed_step, std::nullopt);
      if (!step) {
        return false;  // what they said has settled it, or the scan that was judged meanwhile
      }
      told = false;
      changed = true;  // motors must not start because a scan was taken out
    }
    if (settled && ((told && scan_asked) || !(changed || must_wait(step)))) {
      scan_asked = false;
      asked_once = true;
      begin_retake(step);
      return true;
    }
    if (settled && !told) {
      scan_asked = false;  // of a key that was pressed too early: the tablet may not lie there yet
      WaitsForOperator event;
      if (step && !step->again) {
        event.next = step->view;
      }
      event.not_taken_up = asked_once && !last_scan_taken_up;
      lock.unlock();
      emit(event);
      lock.lock();
      told = true;
      continue;
    }
    lock.unlock();
    change_settings();
    const bool showed = show_camera();
    lock.lock();
    if (!showed) {
      // Cancelling a job wakes nobody.
      pace.wait_for(lock, std::chrono::milliseconds(50), [&] {
        return finish_asked || (!thinks_over() && (changed_step || scan_asked || !told));
      });
    }
  }
}

void Engine::Impl::end_conclusive(const RedMap& red_map, const ScanToPlan& item) {
  const std::scoped_lock lock(mutex);
  const bool is_due = options.first_scan_waits || (asked_once && !item.resumed);
  const bool ends = red_map.conclusive && is_due && to_take_again.empty();
  changed_step.reset();
  if (ends) {
    changed_step.emplace(std::nullopt);
  }
  pace.notify_all();
}

void Engine::Impl::show_model(JobContext& job) {
  if (!options.show_model || job.cancelled()) {
    return;
  }
  Result<Mesh> mesh = planning.mesh(job);
  if (!mesh || mesh->faces.empty()) {
    return;
  }
  const auto shown = std::make_shared<const Mesh>(std::move(*mesh));
  emit(ModelChanged{shown, std::make_shared<const ColouredPoints>(planning.red_points(*shown)),
                    planning.tablet_from_model(*shown)});
}

}  // namespace dubsar
