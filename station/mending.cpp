// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mending.h"

#include <algorithm>

#include "station/plan_again.h"
#include "station/results.h"
#include "station/scan_set.h"
#include "station/session_pages.h"
#include "station/session_wedges.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMended = "it was mended";

bool any_below(const std::vector<std::string>& names, const std::string& folder) {
  return std::ranges::any_of(names, [&](const std::string& name) { return name.starts_with(folder + "/"); });
}

/// Mesh, pictures, pages and wedges of the session as its scans and poses give them.
Status make_derived_anew(const fs::path& session, const std::vector<std::string>& lost, JobContext& job) {
  Result<ScanSet> set = load_scan_set(session, {}, job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<PlannedAgain> planned = plan_again(*set, set->poses, job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  const PageFacts facts = page_facts_of(*set->store);
  const bool were_taken_back = pages_are_taken_back(*set->store);
  if (any_below(lost, "mesh") || any_below(lost, "export")) {
    const Result<Deliverables> kept =
        keep_deliverables(*set->store, report_input(planned->results, *planned->stage, facts), job);
    if (!kept) {
      return std::unexpected(kept.error());
    }
    // The poses may not follow yet what was said of the scans: plan sees to that.
    if (Status taken = were_taken_back ? take_pages_back(*set->store, kMended, kFollowAndPlan) : Status();
        !taken) {
      return taken;
    }
  }
  if (any_below(lost, "analysis")) {
    const auto wedges = keep_wedges(*set->store, planned->results.mesh, job);
    if (!wedges) {
      return std::unexpected(wedges.error());
    }
  }
  return {};
}

}  // namespace

Result<Mended> mend_session(const fs::path& session, const VerifyReport& found,
                            const std::optional<fs::path>& copy, JobContext& job) {
  Mended out;
  Result<std::vector<std::string>> kept = SessionStore::keep_damaged_records(session, found);
  if (!kept) {
    return std::unexpected(kept.error());
  }
  RepairReport repaired;
  std::string lost_scan;  // one that the derived files would lack
  {
    Result<SessionStore> store =
        copy ? SessionStore::open_with_copy(session, *copy) : SessionStore::open(session);
    if (!store) {
      return std::unexpected(store.error());
    }
    out.notes = store->opening().notes;
    out.records = store->opening().brought_back;
    if (store->opening().no_use_of_copy) {
      out.beyond.push_back(*store->opening().no_use_of_copy);
    }
    // Opened for writing, the tables are whole; what the grids and other files are is to be seen once more.
    Result<VerifyReport> now = store->verify(job);
    if (!now) {
      return std::unexpected(now.error());
    }
    Result<RepairReport> done = store->repair(*now, copy, job);
    if (!done) {
      return std::unexpected(done.error());
    }
    repaired = std::move(*done);
    const Result<std::vector<StoredScan>> scans = store->scans();
    if (!scans) {
      return std::unexpected(scans.error());
    }
    for (const StoredScan& scan : *scans) {
      lost_scan = scan.damaged && !scan.dropped && lost_scan.empty() ? scan.file : lost_scan;
    }
  }
  out.restored = repaired.restored;
  out.beyond.insert(out.beyond.end(), repaired.beyond.begin(), repaired.beyond.end());
  if (!repaired.derived.empty() && !lost_scan.empty()) {
    // It would be made of fewer scans than the one that was lost, and nobody could tell.
    for (const std::string& name : repaired.derived) {
      out.beyond.push_back({ErrorKind::kBadInput, "cannot be made anew without " + lost_scan, name,
                            "bring that back from a copy, or drop the scan, and repair again"});
    }
  } else if (!repaired.derived.empty()) {
    if (const Status made = make_derived_anew(session, repaired.derived, job); made) {
      out.made_anew = repaired.derived;
    } else if (made.error().kind == ErrorKind::kCancelled) {
      return std::unexpected(made.error());
    } else {
      out.beyond.push_back(made.error());
    }
  }
  if (lost_scan.empty() && !(out.records.empty() && out.notes.empty())) {
    // What came back, or is lost of the record, may have been said of scans or places that the pages show.
    Result<SessionStore> store = SessionStore::open(session);
    const bool behind = store && !why_pages_are_behind(*store).empty();
    if (const Status taken = behind ? take_pages_back_once(*store, kMended, kFollowAndPlan) : Status();
        !taken) {
      out.beyond.push_back(taken.error());
    }
  }
  const Result<SessionStore> after = SessionStore::open(session, SessionStore::Access::kReadOnly);
  Result<VerifyReport> now = after ? after->verify(job) : std::unexpected(after.error());
  if (!now) {
    return std::unexpected(now.error());
  }
  std::ranges::set_difference(now->set_aside, found.set_aside, std::back_inserter(out.set_aside));
  std::erase_if(out.made_anew, [&](const std::string& name) {
    return std::ranges::find(now->whole, name) == now->whole.end();
  });
  return out;
}

}  // namespace dubsar
