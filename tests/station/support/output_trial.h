// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/station/support/faulted_command.h"

namespace dubsar::test {

/// A verb that reads files and writes files, with no session: to be killed or refused while it does.
struct OutputVerb {
  std::string name;
  Arguments arguments;          ///< "FOLDER" stands for the folder that everything lies in
  bool may_do_without = false;  ///< its files only save time: done without them is done
  bool repeats = true;          ///< started again it ends as if it had not been started before
  Arguments then = {};          ///< what it asks for after that, if it may ask for something
};
[[nodiscard]] std::vector<OutputVerb> output_verbs();

/// A folder with a mesh, its wedges, scans with poses, pictures of a board, a calibration and an artefact,
/// and copies of it for trials.
class OutputTrials {
 public:
  /// Makes all that with the command itself. Throws std::runtime_error when that fails.
  OutputTrials(std::filesystem::path folder, std::uint64_t seed);

  /// Runs the verb in the folder with the fault, then looks at what is left: every file is whole, either as
  /// it was or as the verb leaves it undisturbed; a verb that says that it is done has left all of its files;
  /// one that was refused says so in one line; and started again, it ends as if nothing had happened.
  [[nodiscard]] TrialOutcome run(const OutputVerb& verb, const Fault& fault);
  /// Calls that the verb takes undisturbed, and what it leaves, for the trials that follow.
  [[nodiscard]] TrialOutcome undisturbed(const OutputVerb& verb);

 private:
  using Files =
      std::map<std::string, std::string>;  ///< of each its bytes, less times and what follows from them
  [[nodiscard]] Files files() const;
  void lay_out() const;
  void must(const Arguments& arguments) const;
  void look(const OutputVerb& verb, TrialOutcome& out) const;

  std::filesystem::path folder_;
  std::filesystem::path prepared_;
  std::filesystem::path place_;
  Files before_;
  Files after_;
  int status_ = 0;
};

}  // namespace dubsar::test
