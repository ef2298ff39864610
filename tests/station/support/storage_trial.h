// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "tests/station/support/faulted_command.h"

namespace dubsar::test {

/// A verb of the command that writes, to be killed or refused while it does.
struct WritingVerb {
  std::string name;
  Arguments arguments;       ///< "SESSION", "FOLDER" and "REGISTERED" stand for the session, for the folder
                             ///< that it lies in and for a scan that has its place
  bool on_a_session = true;  ///< on a copy of one that was scanned before; else there is none yet
  /// Whether a session shows what the verb does: asked when it has said that it is done.
  std::function<bool(const SessionStore&)> is_done = {};
  bool damaged = false;  ///< the tables of the session, with a log beside them, before the verb begins
};
[[nodiscard]] std::vector<WritingVerb> writing_verbs();

/// A tablet scanned a few times, and copies of its session for trials, in a folder that goes with this.
class StorageTrials {
 public:
  /// Scans the small simulated tablet of this seed. Throws std::runtime_error when that fails.
  StorageTrials(std::filesystem::path folder, std::uint64_t seed);

  /// Runs the verb in a folder of its own with the fault, then looks at what is left: every scan that had
  /// been reported as stored is there and whole, the session opens and verifies, nothing half-written bears a
  /// name, and a verb that was refused by the disk says so in one line.
  [[nodiscard]] TrialOutcome run(const WritingVerb& verb, const Fault& fault);
  /// Seconds and calls that the verb takes undisturbed.
  [[nodiscard]] TrialOutcome undisturbed(const WritingVerb& verb) { return run(verb, {}); }

 private:
  void look(const WritingVerb& verb, const std::filesystem::path& folder, TrialOutcome& out) const;

  std::filesystem::path folder_;
  std::filesystem::path scanned_;
  std::vector<int> scans_;  ///< of the scanned session
  std::size_t events_ = 0;  ///< in its record
  std::string device_;
  std::string registered_;  ///< the number of a scan
  int runs_ = 0;
};

}  // namespace dubsar::test
