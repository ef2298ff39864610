// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/plan_keeping.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "core/log.h"
#include "formats/red_map_json.h"
#include "station/followed_word.h"
#include "station/offline.h"
#include "station/results.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += (text.empty() ? "" : "; ") + part;
  }
  return text;
}

/// Compares with what is stored, and stores what is new, the poses that the verdict rests on with it; of the
/// same red map its checklist. A red map that was signed is never replaced.
Result<PlanComparison> compare_and_keep(SessionStore& store, Results& results, bool poses_are_new,
                                        bool may_write, const JobContext& job) {
  const auto differs = differs_from_stored(store, results.red_map);
  PlanComparison out;
  if (differs && *differs) {
    out.compared = true;
    out.differs = **differs;
    const auto stored = store.load_document("red_map");
    const bool is_same = out.differs.empty() && stored && *stored == red_map_to_json(results.red_map);
    if (is_same && !poses_are_new) {
      const Result<bool> anew =
          may_write ? keep_checklist_anew(store, results.checklist) : Result<bool>(false);
      out.made_new = anew && *anew;
      return anew ? Result<PlanComparison>(std::move(out)) : std::unexpected(anew.error());
    }
    if (!out.differs.empty()) {
      log_warning("the stored red map is not what its scans and poses give: " + joined(out.differs));
    }
    if (results.checklist.sign_off && results.checklist.sign_off->holds()) {
      out.kept = true;
      if (!out.differs.empty()) {
        log_warning("it was signed and is kept; `dubsar register` and `dubsar scan` make new ones");
      }
      return out;
    }
  } else if (!differs) {
    log_warning(differs.error().line());
  }
  if (!may_write) {
    log_warning(store.folder().string() +
                ": it cannot be written to, so that it keeps the verdict that it has");
    out.kept = true;
    return out;
  }
  if (const Status saved = poses_are_new ? save_followed_poses(store, results.poses) : Status(); !saved) {
    return std::unexpected(saved.error());
  }
  if (const Status kept = keep_verdict(store, results, job); !kept) {
    return std::unexpected(kept.error());
  }
  out.made_new = true;
  const Status noted = store.append_event(
      "planned",
      nlohmann::ordered_json{{"conclusive", results.red_map.conclusive}, {"differed", out.differs}}.dump());
  return noted ? Result<PlanComparison>(std::move(out)) : std::unexpected(noted.error());
}

/// No page of the session may say what is not so: they are made anew where the verdict is, or where they were
/// behind; while the poses do not follow what was said of the scans they are taken back.
Status follow_with_pages(SessionStore& store, const PlannedAgain& planned, const PlanComparison& comparison,
                         const PlanKeeping& is, JobContext& job) {
  if (!comparison.made_new && is.behind.empty() && is.not_followed.empty()) {
    return {};
  }
  if (is.may_write && !is.not_followed.empty()) {
    // Those that tell to run this alone would only lead back to here.
    return mend_of_pages(store) == kPlan ? take_pages_back(store, is.not_followed, kFollowAndPlan)
                                         : take_pages_back_once(store, is.not_followed, kFollowAndPlan);
  }
  if (!is.may_write || comparison.kept) {
    if (!is.behind.empty()) {
      log_warning(store.folder().string() + ": its pages stay behind");
    }
    return {};
  }
  const Result<bool> written = keep_pages_anew(store, planned, job);
  if (written && !*written) {
    log_warning(store.folder().string() + ": its pages stay behind, for scans of it are lost");
  }
  return written ? Status() : std::unexpected(written.error());
}

}  // namespace

Result<PlanComparison> keep_in_session(ScanSet& set, PlannedAgain& planned, PlanKeeping is, JobContext& job) {
  SessionStore& store = *set.store;
  is.behind = why_pages_are_behind(store);
  if (!is.behind.empty()) {
    const std::string told = store.folder().string() + ": its pages are behind: " + is.behind;
    pages_are_taken_back(store) ? log_info(told) : log_warning(told);
  }
  Result<PlanComparison> comparison =
      compare_and_keep(store, planned.results, !all_judged(set), is.may_write, job);
  if (!comparison) {
    return comparison;
  }
  const Status followed = follow_with_pages(store, planned, *comparison, is, job);
  return followed ? std::move(comparison) : std::unexpected(followed.error());
}

}  // namespace dubsar
