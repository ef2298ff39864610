// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/engine_impl.h"
#include "station/kept_surface.h"
#include "station/results.h"
#include "station/session_pages.h"
#include "station/session_wedges.h"

namespace dubsar {

/// Mesh, checklist, pictures and pages of the settled scans; the verdict and what it rests on go into the
/// session, so that anyone can work it out again.
Status Engine::Impl::finish(EngineResult& result, JobContext& job) {
  if (const Status judged_so = judge_by_kept_rig(result, job); !judged_so) {
    return judged_so;
  }
  const std::optional<Rig> reach = kept_rig();
  Results results{result.poses, result.red_map, {}, {}};
  {
    const StageClock timing = clock("final planning and meshing");
    Result<Mesh> stitched = planning.mesh(job);
    if (!stitched) {
      return std::unexpected(stitched.error());
    }
    results.mesh = std::move(*stitched);
  }
  for (std::string& warning : planning.warnings_of_mesh(names)) {
    emit(Notice{std::move(warning)});
  }
  {
    const StageClock timing = clock("checklist");
    Result<Checklist> list = checklist_of(result.red_map, result.poses, planning, results.mesh,
                                          reach ? &*reach : nullptr, &*store, job);
    if (!list) {
      return std::unexpected(list.error());
    }
    results.checklist = result.checklist = std::move(*list);
  }
  std::optional<SessionWedges> wedges;
  {
    const StageClock timing = clock("wedges");
    auto kept = keep_wedges(*store, results.mesh, job);
    if (!kept) {
      return std::unexpected(kept.error());
    }
    wedges = std::move(*kept);
  }
  for (const auto& [stage, spent] : seconds) {
    result.timings.push_back({stage, spent});
  }
  result.device_error = device_error;

  LapClock writing(&result.timings);
  PageFacts facts = page_facts_of(*store);
  if (std::string device = scanned_with(); !device.empty()) {
    facts.device = std::move(device);
  }
  facts.timings = result.timings;
  facts.wedges.clear();
  if (wedges) {
    tell_wedges(facts, *wedges);
  }
  facts.gains.insert(facts.gains.end(), planning.gains().begin(), planning.gains().end());
  if (const Status s = keep_page_facts(*store, facts); !s) {
    return s;
  }
  if (const Status s = keep_verdict(*store, results, job); !s) {
    return s;
  }
  result.checklist = results.checklist;
  Result<Deliverables> files = keep_deliverables(*store, report_input(results, planning, facts), job);
  if (!files) {
    return std::unexpected(files.error());
  }
  result.files = std::move(*files);
  if (wedges) {
    result.files.wedges = wedges->json;
  }
  writing.done("pictures and pages");
  return store->append_event(
      "finished", result.red_map.conclusive ? R"({"conclusive":true})" : R"({"conclusive":false})");
}

}  // namespace dubsar
