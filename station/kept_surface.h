// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "station/plan_again.h"
#include "station/session_wedges.h"

namespace dubsar {

// What a session keeps of one surface: its mesh, the wedges that were measured on it, and the pages that tell
// of both. None of them may say that it is of another one than it is of.

/// Mesh, wedges, pictures and pages of a verdict that was just kept, all of one surface: wedges are measured
/// where the session has none of it, and pages that tell of others are taken back before that. Errors:
/// kCancelled, those of the store.
[[nodiscard]] Result<Deliverables> keep_all_anew(SessionStore& store, const PlannedAgain& planned,
                                                 JobContext& job);
/// As keep_deliverables() of results.h, but only those of these names: the others stay to the byte.
[[nodiscard]] Result<Deliverables> keep_deliverables(SessionStore& store, const ReportInput& input,
                                                     const std::vector<std::string>& names, JobContext& job);
/// As write_deliverables(), likewise.
[[nodiscard]] Result<Deliverables> write_named(SessionStore& store, const ReportInput& input,
                                               const FileLabel& label, const std::vector<std::string>& names,
                                               JobContext& job);

/// Wedges and drawings of these names ("analysis/top.svg"), of the mesh that stands in the session: the
/// drawings of wedges.json as it is, unless that is one of the names; then the wedges are measured, and all
/// drawn; pages that tell of another number are taken back: true then. Errors: kCancelled, those of reading
/// and writing.
[[nodiscard]] Result<bool> make_wedges_anew(SessionStore& store, const std::vector<std::string>& names,
                                            JobContext& job);

/// Into what a page tells, in the place of what it told before.
void tell_wedges(PageFacts& facts, const SessionWedges& wedges);
/// What a page of this mesh may tell of the wedges that the session keeps, likewise; nothing where the last
/// run looked for none.
void tell_kept_wedges(PageFacts& facts, const SessionStore& store, const Mesh& mesh, const JobContext& job);
/// That sentence into the facts of the last run, whose others stay; nothing where none are kept.
[[nodiscard]] Status keep_wedges_word(SessionStore& store, const std::string& sentence);

}  // namespace dubsar
