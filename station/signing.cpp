// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/signing.h"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/session_presence.h"
#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "station/followed_word.h"
#include "station/kept_surface.h"
#include "station/not_conclusive.h"
#include "station/plan_again.h"
#include "station/session_faults.h"

namespace dubsar {

namespace {

/// Why this must not be signed, whatever the operator says.
std::optional<Error> stale(const ScanSet& set, const RedMap& anew, const std::string& where) {
  for (const StationScan& scan : set.scans) {
    if (std::ranges::find(set.poses, scan.id, &ScanPose::id) == set.poses.end()) {
      return Error{ErrorKind::kUsage, fmt::format("scan {} was never judged", scan.id), where,
                   "run dubsar register and dubsar plan on it first"};
    }
  }
  const Result<std::string> behind = not_followed_sentence(set);
  if (!behind) {
    return behind.error();
  }
  if (!behind->empty()) {
    return Error{ErrorKind::kUsage, *behind, where, "run dubsar register and dubsar plan on it first"};
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
    return Error{ErrorKind::kUsage, not_conclusive(red_mm2), where, mend};
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

}  // namespace

Result<Signing> sign_verdict(const std::filesystem::path& session, SignOff wanted, JobContext& job) {
  if (const Status there = check_is_session(session); !there) {
    return std::unexpected(there.error());
  }
  Result<ScanSet> set = load_scan_set(session, {}, job);
  if (!set) {
    return std::unexpected(set.error());
  }
  Result<PlannedAgain> planned = plan_again(*set, set->poses, job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  Results& results = planned->results;
  Signing out;
  out.checklist = results.checklist;
  if (out.refused = stale(*set, results.red_map, session.string()); out.refused) {
    return out;
  }
  if (out.refused = falls_short(*set, results, session.string()); out.refused && wanted.incomplete.empty()) {
    return out;
  }
  if (!out.refused && !wanted.incomplete.empty()) {
    return fail(ErrorKind::kUsage, "it is conclusive and whole: there is nothing that it falls short of",
                session.string(), "sign it without --incomplete; --note takes a remark");
  }
  out.refused.reset();
  SessionStore& store = *set->store;
  if (const Status kept = keep_verdict(store, results.red_map, results.checklist); !kept) {
    return std::unexpected(kept.error());
  }
  wanted.conclusive = results.red_map.conclusive;
  wanted.when = utc_now();
  wanted.program = program_name();
  const Result<SignOff> made = sign_session(store, std::move(wanted), job);
  if (!made) {
    return std::unexpected(made.error());
  }
  out.made = *made;
  if (const std::set<std::string> lost = lost_records(store); !lost.empty()) {
    log_warning("the session has lost records: " + one_line(lost));
  }
  // The pages show it; should they fail to be written, it still stands.
  results.checklist.sign_off = CheckedSignOff{*made, {}};
  out.checklist = results.checklist;
  const Result<Deliverables> files = keep_all_anew(store, *planned, job);
  if (files) {
    out.page = files->checklist;
  } else {
    out.no_pages = files.error();
  }
  return out;
}

}  // namespace dubsar
