// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "core/job.h"
#include "core/red_map.h"
#include "station/engine.h"

namespace dubsar {

/// The operator at the terminal, of a run of the engine that waits for a word: asks for each turn by hand,
/// and lets the run go on once Enter was pressed, what was typed before not counted. `q` or the end of the
/// input ends the run in good order; so does the lack of a terminal, with a line that says what to turn.
class HandTurns {
 public:
  /// Engine and job outlive it, `session` is for what is said.
  HandTurns(Engine& engine, std::string session, const JobContext& job);

  /// Of the engine's event sink, from all of its threads: true where all is said of the event.
  bool hear(const Event& event);

 private:
  void ask(const std::optional<NextView>& next, const std::stop_token& is_over);
  void answer(OperatorCommand command);
  void hear_judged(const RedMapChanged& judged);

  Engine& engine_;
  std::string session_;
  const JobContext& job_;
  std::mutex mutex_;           ///< of what follows, but for the thread
  bool asks_for_any_ = false;  ///< a scanner without motors waits, for a turn that the red map tells
  bool drives_now_ = false;    ///< the turn of the placement that comes was asked for
  std::string told_next_;      ///< by the red map, since the last answer
  std::jthread asking_;        ///< the last question's
};

}  // namespace dubsar
