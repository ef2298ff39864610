// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "station/plan_again.h"
#include "station/scan_set.h"

namespace dubsar {

/// How the red map compares with the one that the session holds.
struct PlanComparison {
  bool compared = false;
  std::vector<std::string> differs;
  bool kept = false;      ///< the stored one, since its signature holds or the session cannot be written to
  bool made_new = false;  ///< what was worked out is kept now
};

/// Whether the session keeps what was worked out, and how its pages came to it.
struct PlanKeeping {
  std::string not_followed;  ///< as not_followed_sentence() has it
  std::string behind;        ///< why its pages were behind when it was read; empty where they were not
  bool may_write = true;
};

/// What `dubsar plan` worked out of a session beside what that holds: it keeps what is new, and its pages
/// follow.
[[nodiscard]] Result<PlanComparison> keep_in_session(ScanSet& set, PlannedAgain& planned, PlanKeeping is,
                                                     JobContext& job);

}  // namespace dubsar
