// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "station/plan_again.h"
#include "station/results.h"
#include "station/scan_set.h"

namespace dubsar {

/// Pages as the session keeps them.
struct KeptPages {
  std::string report;     ///< HTML
  std::string checklist;  ///< HTML
  std::string red_sheet;  ///< PNG
};

/// What is wrong with the record of the session; its grids, each of which is marked itself, are left aside.
[[nodiscard]] std::vector<Error> damage_of_record(const SessionStore& store);

/// What a package is made of: the verdict with its mesh and pages, as the session keeps them or worked out
/// anew.
class PackageSource {
 public:
  /// Takes what the session keeps where its record, mesh, red map, poses, pages and sign-off all belong
  /// together and are whole, whatever else of it is damaged; else goes through grids and poses again, as
  /// `plan` does, which takes far longer. Opens the session for reading only. Errors: those of the store and
  /// of the stages, kCancelled.
  [[nodiscard]] static Result<PackageSource> open(const std::filesystem::path& session, JobContext& job);

  [[nodiscard]] const SessionStore& store() const { return set_ ? *set_->store : *store_; }
  [[nodiscard]] const Results& results() const { return planned_ ? planned_->results : results_; }
  /// Which way the tablet lies, as verdict and report name its sides.
  [[nodiscard]] const RigidTransform& tablet_from_model() const { return tablet_from_model_; }
  /// Nothing when the verdict was worked out anew: report_input() then has what they are made of.
  [[nodiscard]] const std::optional<KeptPages>& pages() const { return pages_; }
  /// Why that is so: "export/report.html is not as it was stored (missing)". Empty where there are pages, and
  /// where the session keeps none.
  [[nodiscard]] const std::string& why_anew() const { return why_anew_; }
  /// What the poses do not follow yet, as not_followed_sentence() has it; empty where they follow.
  [[nodiscard]] const std::string& behind() const { return behind_; }
  /// What the files of the session were when it was opened.
  [[nodiscard]] const VerifyReport& found() const { return found_; }
  /// Only where pages() is nothing.
  [[nodiscard]] ReportInput input(const PageFacts& facts) const {
    return report_input(planned_->results, *planned_->stage, facts);
  }

 private:
  /// Fills in pages(), or why_anew().
  Status take_kept(JobContext& job);

  std::optional<SessionStore> store_;
  Results results_;
  VerifyReport found_;
  std::optional<KeptPages> pages_;
  std::string why_anew_;
  std::string behind_;
  std::optional<ScanSet> set_;
  std::optional<PlannedAgain> planned_;
  RigidTransform tablet_from_model_;
};

}  // namespace dubsar
