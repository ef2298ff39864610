// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/result.h"
#include "station/plan_again.h"

namespace dubsar {

// The pages that a session keeps in export/ say what was so when they were made. None may go on saying it
// once scans, places or the verdict have changed: they are taken back before the change is stored, so that no
// moment of it, and no kill, leaves a page that says what is not so. Whoever keeps a verdict makes them anew.

/// The pages for people. red_map.json, red_map.png and poses.json lie beside them and say as much; a picture
/// of the six sides says nothing of it.
inline constexpr std::array<const char*, 2> kPages = {"export/checklist.html", "export/report.html"};

/// What makes pages anew: where something was said of scans that the poses have to follow first, and where
/// not.
inline constexpr const char* kFollowAndPlan = "run dubsar register and dubsar plan on the session";
inline constexpr const char* kPlan = "run dubsar plan on the session";

/// Puts one that says that it is behind in the place of each of these files that is there, whole: a red map
/// that is not conclusive and poses of no scan among them. A few small files: quick. `what` was changed, as
/// "scan 4 was taken out"; `mend`: kPlan or the like. Errors: kStorage.
Status take_pages_back(SessionStore& store, std::string_view what, std::string_view mend);
/// Nothing where they were taken back before: then the first change since stands on them.
Status take_pages_back_once(SessionStore& store, std::string_view what, std::string_view mend);

/// Puts what the session says of the tablet now at the head of the pages that are there: neither verdict nor
/// signature follow from it. A damaged page stays as it is. Reads the session whole where there is a page.
/// Errors: kCancelled, kStorage.
Status pages_follow_record(SessionStore& store, JobContext& job);

/// What makes pages that were taken back anew, as they say themselves; of others kPlan.
[[nodiscard]] std::string mend_of_pages(const SessionStore& store);

/// Whether there is a page, and none but those that say that they are behind.
[[nodiscard]] bool pages_are_taken_back(const SessionStore& store);

/// Why the pages that the session keeps are not of the verdict, the scans and the places that it holds now;
/// empty where they are, and where it keeps none. Scans that are damaged are left aside: verify() names them.
[[nodiscard]] std::string why_pages_are_behind(const SessionStore& store);

/// Red map and checklist into the session's documents, as keep_verdict() of results.h; the latest sign-off is
/// held against what is kept now, not against what it replaces.
[[nodiscard]] Status keep_verdict(SessionStore& store, Results& results, const JobContext& job);

/// The checklist alone, of the red map that is kept: where it says something else than the kept one, free
/// space and the time of the last check aside. True where that is more than who has signed: then pages are
/// behind. Errors: the store's.
[[nodiscard]] Result<bool> keep_checklist_anew(SessionStore& store, const Checklist& checklist);

/// As write_deliverables(), but for the mesh.
[[nodiscard]] Status write_pages(SessionStore& store, const ReportInput& input, const FileLabel& label,
                                 JobContext& job);

/// Pictures and pages of a verdict that was just kept. The mesh stays: a person's selections may be of it, or
/// it may be the only record of scans that are lost. Where some are, their pages go with it: then they are
/// taken back and no others made. True where they were made. Errors: kCancelled, those of the store.
[[nodiscard]] Result<bool> keep_pages_anew(SessionStore& store, const PlannedAgain& planned, JobContext& job);

}  // namespace dubsar
