// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/station/support/command.h"

namespace dubsar::test {

/// What the disk, or a power switch, does.
struct Fault {
  std::string what;          ///< see storage_faults.c; empty: nothing at a call
  std::int64_t at = 0;       ///< the number of the call, from 1
  bool stays = false;        ///< a disk that stays full
  double kill_after_s = -1;  ///< SIGKILL then; negative: not
};

struct TrialOutcome {
  Outcome command;
  std::int64_t calls = 0;  ///< that would have changed something, until it ended
  std::string met;         ///< the call that met the fault, or nothing
  bool killed = false;
  double seconds = 0;               ///< that it ran
  double open_s = 0;                ///< of opening the session afterwards
  std::vector<std::string> faults;  ///< what must never be; empty when all is well
};

/// Runs the command; calls that change something below `folder` are counted and may meet the fault. `log` is
/// a file that is made anew, outside of it. Adds to the faults: it hung, died of a signal, ended with a
/// status that is not for a disk that refuses, did not say why in one line, or left temporary files where it
/// could take them away.
[[nodiscard]] TrialOutcome run_with_fault(const Arguments& arguments, const std::filesystem::path& folder,
                                          const std::filesystem::path& log, const Fault& fault);

/// The words with each NAME in them replaced.
[[nodiscard]] Arguments filled_in(Arguments arguments,
                                  const std::vector<std::pair<std::string, std::string>>& names);

}  // namespace dubsar::test
