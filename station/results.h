// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/checklist.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/red_map.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "core/stage_times.h"
#include "station/deliverables.h"
#include "station/planning_stage.h"

namespace dubsar {

/// Where the verdict stands: what engine, `plan` and `session sign` hand on to people and archives.
struct Results {
  std::vector<ScanPose> poses;
  RedMap red_map;
  Mesh mesh;
  Checklist checklist;
};

/// "2026-01-02T03:04:05Z"
[[nodiscard]] std::string utc_text(std::time_t time);
[[nodiscard]] std::string utc_now();
/// "Dubsar 0.1.0"
[[nodiscard]] std::string program_name();

/// The checklist of what the stage has placed. With a session: its disk, a verification of every stored byte,
/// the latest sign-off held against it, and without a rig what it knows of a range camera. Errors:
/// kCancelled.
[[nodiscard]] Result<Checklist> checklist_of(const RedMap& red_map, const std::vector<ScanPose>& poses,
                                             const PlanningStage& stage, const Mesh& mesh, const Rig* rig,
                                             const SessionStore* store, JobContext& job);

/// What a page says beside the results.
struct PageFacts {
  std::string title;
  TabletWords tablet{};
  std::string device;
  StageTimes timings;
  std::vector<ViewGain> gains;                 ///< of the scans that were asked for, as they came
  std::string wedges;                          ///< a sentence on them; empty where they were not measured
  std::vector<WedgeProfile> wedge_profiles{};  ///< of these; not kept with the facts, as wedges.json has them
  std::vector<ScanEntry> scans{};              ///< of the session, those that were taken out too
  std::string program{};  ///< that scanned and judged, as the session says; empty when it does not
};

/// The input of pages and pictures. Refers to the results.
[[nodiscard]] ReportInput report_input(const Results& results, const PlanningStage& stage,
                                       const PageFacts& facts);

/// Keeps the facts in the session (document "run"), so that its pages can be made again; and reads them.
[[nodiscard]] Status keep_page_facts(SessionStore& store, const PageFacts& facts);
[[nodiscard]] PageFacts page_facts_of(const SessionStore& store);

/// Red map and checklist into the session's documents; pages of another red map are taken back before that.
[[nodiscard]] Status keep_verdict(SessionStore& store, const RedMap& red_map, const Checklist& checklist);

/// The poses of the scans that stand: neither taken out nor damaged.
[[nodiscard]] Result<std::vector<ScanPose>> standing_poses(const SessionStore& store);

/// What a mesh depends on, as a digest: program, and which registered scans lie where, how certainly.
[[nodiscard]] std::string origin_of_mesh(std::vector<ScanPose> poses);

/// The file of stored_mesh(), which is not read as a mesh; nothing otherwise. Errors: kCancelled.
[[nodiscard]] Result<std::optional<std::filesystem::path>> stored_mesh_file(
    const SessionStore& store, const std::vector<ScanPose>& poses, JobContext& job);

/// The session's stored mesh, when it was stitched of just these registered scans in just these places by
/// this program, and its file is as it was stored; nothing otherwise.
[[nodiscard]] std::optional<Mesh> stored_mesh(const SessionStore& store, const std::vector<ScanPose>& poses,
                                              JobContext& job);

/// Which way the tablet lies in the frame of the session's stored mesh, as its pages name the sides; nothing
/// where none is kept (a session of an earlier version).
[[nodiscard]] std::optional<RigidTransform> stored_tablet_from_model(const SessionStore& store);

/// Mesh, pictures and pages into the session, each with its checksum.
[[nodiscard]] Result<Deliverables> keep_deliverables(SessionStore& store, const ReportInput& input,
                                                     JobContext& job);

}  // namespace dubsar
