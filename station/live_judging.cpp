// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The verdict of what is stored, where no run is under way: as `dubsar plan` works it out, without a scanner.
#include <nlohmann/json.hpp>
#include <utility>

#include "station/followed_word.h"
#include "station/live_session.h"
#include "station/offline.h"
#include "station/plan_again.h"
#include "station/session_pages.h"

namespace dubsar {

void LiveSession::judge() {
  launch([this] {
    {
      const std::scoped_lock lock(mutex_);
      state_.phase = LivePhase::kFinishing;
    }
    changed();
    end(judge_stored());
  });
}

Status LiveSession::judge_stored() {
  ScanSetOptions reading;
  reading.again = true;  // what there is to say of the session was said when it was opened
  Result<ScanSet> set = load_scan_set(options_.session, reading, *job_);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::string> behind = not_followed_sentence(*set);
  if (!behind) {
    return std::unexpected(behind.error());
  }
  const bool stands = behind->empty() && all_judged(*set);
  const Result<std::vector<ScanPose>> poses =
      stands ? Result<std::vector<ScanPose>>(set->poses) : register_scans(*set, {}, *job_);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  Result<PlannedAgain> planned = plan_again(*set, *poses, *job_);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  Results& results = planned->results;
  SessionStore& store = *set->store;
  if (const Status saved = stands ? Status() : save_followed_poses(store, results.poses); !saved) {
    return saved;
  }
  if (const Status kept = keep_verdict(store, results, *job_); !kept) {
    return kept;
  }
  if (const Result<bool> pages = keep_pages_anew(store, *planned, *job_); !pages) {
    return std::unexpected(pages.error());
  }
  if (!results.mesh.faces.empty()) {
    const auto mesh = std::make_shared<const Mesh>(results.mesh);
    show_model(mesh, std::make_shared<const ColouredPoints>(planned->stage->red_points(*mesh)),
               planned->stage->tablet_from_model(*mesh));
  }
  {
    const std::scoped_lock lock(mutex_);
    follow(results.poses);
    state_.red_map = std::make_shared<const RedMap>(results.red_map);
    state_.verdict_kept = true;
    state_.checklist = results.checklist;
  }
  return store.append_event("planned",
                            nlohmann::ordered_json{{"conclusive", results.red_map.conclusive}}.dump());
}

}  // namespace dubsar
