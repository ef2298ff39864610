// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// session sign: a name under the verdict, once it has been worked out anew.

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "formats/sign_off_json.h"
#include "station/command/session_verbs.h"
#include "station/command/sign_off_words.h"
#include "station/plan_again.h"

namespace dubsar {

namespace {

struct SignArguments {
  std::string path;
  std::string name;
  std::string role;
  std::string note;
  std::string incomplete;
};

/// It ran, but the session is not what may be signed: one line, and status 1.
int refuse(const Error& error, const CommandContext& context) {
  finish_progress();
  log_error(error.line());
  if (context.json) {
    CommandContext::print(error_json(error));
  }
  return 1;
}

/// Why this must not be signed, whatever the operator says.
std::optional<Error> stale(const ScanSet& set, const RedMap& anew, const std::string& where) {
  for (const StationScan& scan : set.scans) {
    if (std::ranges::find(set.poses, scan.id, &ScanPose::id) == set.poses.end()) {
      return Error{ErrorKind::kUsage, fmt::format("scan {} was never judged", scan.id), where,
                   "run dubsar register and dubsar plan on it first"};
    }
  }
  const auto differs = differs_from_stored(*set.store, anew);
  const std::string mend = "run dubsar plan on it, read what it says, and sign again";
  if (!differs) {
    return differs.error();
  }
  if (!*differs) {
    return Error{ErrorKind::kUsage, "it has no verdict yet", where, mend};
  }
  if (!(*differs)->empty()) {
    return Error{ErrorKind::kUsage,
                 "the stored red map is not what its scans and poses give: " + (*differs)->front(), where,
                 mend};
  }
  return std::nullopt;
}

/// What falls short: to be signed only as incomplete, with the reason.
std::optional<Error> falls_short(const ScanSet& set, const Results& results, const std::string& where) {
  const std::string mend = "scan on, or sign it as it is with --incomplete REASON";
  if (!results.red_map.conclusive) {
    double red_mm2 = 0;
    for (const FaceCoverage& face : results.checklist.faces) {
      red_mm2 += face.red_mm2;
    }
    return Error{ErrorKind::kUsage, fmt::format("not conclusive: about {:.1f} mm2 are still red", red_mm2),
                 where, mend};
  }
  if (!results.checklist.store_whole) {
    return Error{ErrorKind::kBadInput, "the session is damaged", where,
                 "see dubsar verify and bring back what is damaged, or sign with --incomplete REASON"};
  }
  for (const Error& damage : set.store->opening().damage) {
    return Error{ErrorKind::kBadInput, damage.line(), where,
                 "bring it back, take the scan out, or sign with --incomplete REASON"};
  }
  return std::nullopt;
}

Result<int> sign(const SignArguments& arguments, CommandContext& context) {
  if (!SessionStore::is_session(arguments.path)) {
    return fail(ErrorKind::kUsage, "no session there", arguments.path,
                "name the folder that a scan was stored in");
  }
  Result<ScanSet> set = load_scan_set(arguments.path, {}, context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  Result<PlannedAgain> planned = plan_again(*set, set->poses, context.job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  Results& results = planned->results;
  if (const auto reason = stale(*set, results.red_map, arguments.path)) {
    return refuse(*reason, context);
  }
  if (const auto reason = falls_short(*set, results, arguments.path);
      reason && arguments.incomplete.empty()) {
    return refuse(*reason, context);
  }
  SessionStore& store = *set->store;
  if (const Status kept = keep_verdict(store, results.red_map, results.checklist); !kept) {
    return std::unexpected(kept.error());
  }
  SignOff wanted;
  wanted.name = arguments.name;
  wanted.role = arguments.role;
  wanted.note = arguments.note;
  wanted.incomplete = arguments.incomplete;
  wanted.conclusive = results.red_map.conclusive;
  wanted.when = utc_now();
  wanted.program = program_name();
  const Result<SignOff> made = sign_session(store, std::move(wanted), context.job);
  if (!made) {
    return std::unexpected(made.error());
  }
  // The pages show it; should they fail to be written, it still stands.
  results.checklist.sign_off = CheckedSignOff{*made, {}};
  const Result<Deliverables> files =
      keep_deliverables(store, report_input(results, *planned->stage, page_facts_of(store)), context.job);
  finish_progress();
  if (!files) {
    log_warning("signed, but the pages could not be made: " + files.error().line());
  }
  const std::string page = files ? files->checklist.string() : std::string();
  if (context.json) {
    CommandContext::print({{"session", arguments.path},
                           {"sign_off", sign_off_json(*results.checklist.sign_off)},
                           {"checklist", page}});
  } else {
    std::printf("%s\n  sha256    %s\n", sign_off_line(*results.checklist.sign_off).c_str(),
                made->digest.c_str());
    if (!page.empty()) {
      std::printf("  checklist %s\n", page.c_str());
    }
  }
  return 0;
}

}  // namespace

void add_session_sign(CLI::App& session, Action& chosen) {
  CLI::App* verb = session.add_subcommand(
      "sign", "Put a name under the verdict; status 1 when there is none to sign, or it falls short");
  const auto arguments = std::make_shared<SignArguments>();
  const auto said = CLI::Validator(
      [](std::string& text) {
        return text.find_first_not_of(" \t\r\n") == std::string::npos ? "says nothing" : std::string();
      },
      "TEXT");
  verb->add_option("session", arguments->path)->required();
  verb->add_option("--name", arguments->name, "who signs")->required()->check(said);
  verb->add_option("--role", arguments->role, "as what");
  verb->add_option("--note", arguments->note, "anything that a reader should know");
  verb->add_option("--incomplete", arguments->incomplete, "sign although it falls short, and why")
      ->check(said);
  verb->fallthrough();
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return sign(*arguments, c); }; });
}

}  // namespace dubsar
