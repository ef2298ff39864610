// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-crash: kills the command, or lets the disk refuse, while it writes, and looks at what is left.
//   dubsar-crash --trials 500 --seed 1     kills, at calls that change something and at any moment, in turn
//   dubsar-crash --refuse                  every such call of every verb meets ENOSPC, EIO and EROFS
//   dubsar-crash --outputs [--refuse]      the verbs that write files and no session, instead
// Status 1 when anything that had been reported as stored was lost, or a session was left damaged.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>

#include "bench/support/options.h"
#include "core/random.h"
#include "tests/station/support/output_trial.h"
#include "tests/station/support/storage_trial.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Fault;
using test::OutputTrials;
using test::StorageTrials;
using test::TrialOutcome;

struct Tally {
  int trials = 0;
  int killed = 0;
  int told = 0;      ///< refused by the disk, said so, status 4
  int survived = 0;  ///< the verb did without what was refused
  int faults = 0;
  double longest_open_s = 0;

  void add(const TrialOutcome& outcome) {
    ++trials;
    killed += outcome.killed ? 1 : 0;
    told += !outcome.killed && outcome.command.status == 4 ? 1 : 0;
    survived += !outcome.killed && outcome.command.status >= 0 && outcome.command.status <= 1 ? 1 : 0;
    faults += outcome.faults.empty() ? 0 : 1;
    longest_open_s = std::max(longest_open_s, outcome.open_s);
  }
  void print(const std::string& name) const {
    std::printf("| %-9s | %6d | %6d | %6d | %6d | %6d | %8.3f |\n", name.c_str(), trials, killed, told,
                survived, faults, longest_open_s);
    std::fflush(stdout);
  }
};

void report(const std::string& verb, const Fault& fault, const TrialOutcome& outcome) {
  for (const std::string& one : outcome.faults) {
    std::fprintf(stderr, "%s, %s at call %lld, %.3f s (%s): %s\n", verb.c_str(), fault.what.c_str(),
                 static_cast<long long>(fault.at), fault.kill_after_s, outcome.met.c_str(), one.c_str());
  }
}

Fault random_kill(Random& random, std::int64_t calls, double seconds) {
  static constexpr const char* kHow[] = {"KILL", "KILL_AFTER", "KILL_HALF"};
  if (random.below(2) == 0) {
    return {.what = {}, .at = 0, .stays = false, .kill_after_s = random.uniform() * seconds};
  }
  return {.what = kHow[random.below(3)],
          .at = 1 + static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(calls))),
          .stays = false,
          .kill_after_s = -1};
}

/// Goes through the verbs (those of `names`, if any): refusals at every so many calls, or, with a stride of
/// 0, kills. False when a verb cannot be tried.
template <typename Trials, typename Verb>
bool try_all(Trials& all, std::vector<Verb> verbs, const std::vector<std::string>& names, int stride,
             int trials, std::uint64_t seed, Tally& sum) {
  if (!names.empty()) {
    std::erase_if(verbs,
                  [&](const Verb& verb) { return std::ranges::find(names, verb.name) == names.end(); });
  }
  Random random(seed);
  for (std::size_t v = 0; v < verbs.size(); ++v) {
    const Verb& verb = verbs[v];
    const TrialOutcome whole = all.undisturbed(verb);
    if (whole.calls == 0 || !whole.faults.empty()) {
      std::fprintf(stderr, "dubsar-crash: %s: %s\n", verb.name.c_str(),
                   whole.calls == 0 ? "no call that writes was counted; is LD_PRELOAD set by another?"
                                    : whole.faults.front().c_str());
      return false;
    }
    Tally tally;
    const auto trial = [&](const Fault& fault) {
      const TrialOutcome outcome = all.run(verb, fault);
      tally.add(outcome);
      sum.add(outcome);
      report(verb.name, fault, outcome);
    };
    if (stride > 0) {
      int turn = 0;
      for (std::int64_t at = 1; at <= whole.calls; at += stride) {
        for (const char* what : {"ENOSPC", "EIO", "EROFS"}) {
          trial({.what = what, .at = at, .stays = turn++ % 2 == 0, .kill_after_s = -1});
        }
      }
    } else {
      // Verbs get equal shares.
      const auto from = static_cast<std::size_t>(trials) * v / verbs.size();
      const auto to = static_cast<std::size_t>(trials) * (v + 1) / verbs.size();
      for (std::size_t i = from; i < to; ++i) {
        trial(random_kill(random, whole.calls, whole.seconds));
      }
    }
    tally.print(verb.name);
  }
  return true;
}

int run(int argc, char** argv) {
  CLI::App app("Kills the command, or lets the disk refuse, while it writes");
  int trials = 500;
  std::uint64_t seed = 1;
  bool refuse = false;
  int stride = 1;
  bool outputs = false;
  std::vector<std::string> names;
  app.add_option("--trials", trials, "kills over all verbs");
  app.add_option("--seed", seed, "of the tablet and of the moments");
  app.add_flag("--refuse", refuse, "let the disk refuse at every call instead");
  app.add_option("--stride", stride, "with --refuse: every so many calls")->check(CLI::PositiveNumber);
  app.add_flag("--outputs", outputs, "verbs that write files and no session");
  app.add_option("--verb", names, "these verbs alone");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }

  const test::TemporaryFolder folder;
  Tally sum;
  const auto go = [&](auto& all, auto verbs) {
    return try_all(all, verbs, names, refuse ? stride : 0, trials, seed, sum);
  };
  std::printf(
      "| verb      | trials | killed |   told | did on | FAULTS | open, s  "
      "|\n|---|---|---|---|---|---|---|\n");
  bool tried = false;
  if (outputs) {
    OutputTrials all(folder.path(), seed);
    tried = go(all, test::output_verbs());
  } else {
    StorageTrials all(folder.path(), seed);
    tried = go(all, test::writing_verbs());
  }
  if (!tried) {
    return 2;
  }
  sum.print("all");
  constexpr double kOpensWithinS = 1;
  if (sum.longest_open_s > kOpensWithinS) {
    std::fprintf(stderr, "dubsar-crash: a session took more than %.0f s to open\n", kOpensWithinS);
  }
  return sum.faults == 0 && sum.longest_open_s <= kOpensWithinS ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
