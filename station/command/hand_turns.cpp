// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/hand_turns.h"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>
#include <utility>

#include "core/log.h"
#include "station/command/operator_lines.h"
#include "station/command/terminal.h"

namespace dubsar {

namespace {

void tell(const std::string& line) {
  finish_progress();
  std::fprintf(stderr, "%s\n", line.c_str());
}

/// "turn …; then turntable to …": what the hand does, and what the motors do behind it.
struct Steps {
  std::string hand, motors;
};

Steps steps_of(const NextView& next) {
  constexpr std::string_view kThen = "; then ";
  const std::size_t then = next.say.find(kThen);
  return then == std::string::npos ? Steps{next.say, "the motors"}
                                   : Steps{next.say.substr(0, then), next.say.substr(then + kThen.size())};
}

}  // namespace

HandTurns::HandTurns(Engine& engine, std::string session, const JobContext& job)
    : engine_(engine), session_(std::move(session)), job_(job) {}

bool HandTurns::hear(const Event& event) {
  if (const auto* waits = std::get_if<WaitsForOperator>(&event)) {
    {
      const std::scoped_lock lock(mutex_);
      asks_for_any_ = !waits->next;
      drives_now_ = waits->next.has_value();
    }
    asking_ =
        std::jthread([this, next = waits->next](const std::stop_token& is_over) { ask(next, is_over); });
    return true;
  }
  if (const auto* judged = std::get_if<RedMapChanged>(&event)) {
    hear_judged(*judged);
    return false;
  }
  const auto* placement = std::get_if<NextPlacement>(&event);
  const std::scoped_lock lock(mutex_);
  if (placement == nullptr || !std::exchange(drives_now_, false)) {
    return false;
  }
  log_info("hands off: " + steps_of(placement->view).motors);  // the turn is done, and not told once more
  return true;
}

void HandTurns::hear_judged(const RedMapChanged& judged) {
  const std::scoped_lock lock(mutex_);
  told_next_ = judged.red_map.conclusive || judged.red_map.next.empty() ? std::string()
                                                                        : judged.red_map.next.front().say;
  if (asks_for_any_ && !told_next_.empty()) {
    tell("next: " + told_next_);
  }
}

void HandTurns::answer(OperatorCommand command) {
  {
    const std::scoped_lock lock(mutex_);
    asks_for_any_ = false;
    told_next_.clear();
  }
  engine_.post(std::move(command));
}

void HandTurns::ask(const std::optional<NextView>& next, const std::stop_token& is_over) {
  if (!OperatorLines::has_terminal()) {
    if (next) {
      log_warning(Error{ErrorKind::kCancelled,
                        "the tablet is to be turned by hand, and there is no terminal to ask at: nothing "
                        "moves, and the run ends",
                        session_, steps_of(*next).hand + ", then give the same command again, at a terminal"}
                      .line());
    }
    answer(Finish{});
    return;
  }
  OperatorLines lines([&] { return job_.cancelled() || is_over.stop_requested(); });
  lines.forget();
  if (next) {
    const Steps steps = steps_of(*next);
    tell("next, by hand: " + steps.hand);
    tell("Enter: it lies so and no hand is near, then " + steps.motors + " and the laser; q: no more scans");
  } else {
    const std::scoped_lock lock(mutex_);
    tell(
        "Enter: the tablet lies as the line next: says and no hand is near, then the laser; q: no more "
        "scans");
    if (!told_next_.empty()) {
      tell("next: " + told_next_);
    }
  }
  std::optional<std::string> line = lines.next();
  for (; line && !line->empty() && *line != "q"; line = lines.next()) {
    tell("Enter or q");
  }
  if (line && line->empty()) {
    answer(ScanNow{});
  } else if (line || !(job_.cancelled() || is_over.stop_requested())) {
    answer(Finish{});
  }
}

}  // namespace dubsar
