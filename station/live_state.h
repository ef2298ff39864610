// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "archive/render_scene.h"
#include "core/checklist.h"
#include "core/mesh.h"
#include "core/pin_set.h"
#include "core/range_grid.h"
#include "core/red_map.h"
#include "core/sample_flags.h"
#include "core/scan_pose.h"
#include "station/calibration_run.h"
#include "station/device_panel.h"
#include "station/grid_picture.h"
#include "station/tablet_record.h"
#include "station/verification.h"

namespace dubsar {

/// What the station is doing for a session, as far as a person beside it cares.
enum class LivePhase {
  kStill,      ///< nothing; `error` says whether something ended it
  kReading,    ///< what the folder holds
  kOpening,    ///< the device
  kMoving,     ///< the rig is driven
  kScanning,   ///< profiles come in
  kJudging,    ///< registration and planning
  kWaiting,    ///< for the operator: they turn the tablet, or say where an unsure scan lies
  kFinishing,  ///< final registration, mesh, wedges, pages
  kSigning,
  kMeasuring,  ///< an artefact, or the pictures of a calibration
  kPacking,    ///< the package of the session
};

/// A scan of the session. The grid is thinned to what a person needs to point at places in it.
struct LiveScan {
  int id = 0;
  std::string file;
  std::int64_t samples = 0;
  std::optional<ScanPose> pose;  ///< nothing while it is judged
  bool dropped = false;
  bool set_aside = false;  ///< by the run that goes on: something was in its way
  bool damaged = false;
  bool hinted = false;       ///< the operator has said where it lies
  std::string note;          ///< why it was dropped
  std::string remark;        ///< of the device that it came from
  std::string fault;         ///< what its damage is; empty where it has none
  bool record_lost = false;  ///< it stands, and may have been taken out
  std::shared_ptr<const RangeGrid> grid;
  std::shared_ptr<const GridPicture> picture;
  /// Likewise, with the pins that stand in it; the same as `grid` where there are none.
  std::shared_ptr<const RangeGrid> measured;
};

/// What has come of the scan under way since somebody looked last.
struct GrowingRows {
  std::uint64_t scan = 0;  ///< another number: another scan, from its first row on
  int first = 0;           ///< row of the scan that rows.shade and rows.state begin with
  int total = 0;           ///< rows of the scan so far
  GridPicture rows;
  /// When the first profile came that nobody has looked at yet; nothing when there is none.
  std::optional<std::chrono::steady_clock::time_point> since;
};

/// A session as it stands: a value that a skin reads between two frames. What is large is shared and never
/// changed.
struct LiveState {
  LivePhase phase = LivePhase::kStill;
  bool reads_folder = false;  ///< of kReading: what is stored, by no run; it is read to its end
  std::string stage;          ///< of a long job, in words
  double fraction = 0;
  std::vector<LiveScan> scans;  ///< by id
  std::shared_ptr<const RedMap> red_map;
  bool verdict_kept = true;  ///< the red map is in the session too; else it was worked out to be seen
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const ColouredPoints> red;  ///< on the mesh
  RigidTransform tablet_from_model;
  std::array<double, kFaceCount> seen_mm2{};  ///< of the mesh, by Face
  std::array<int, kFaceCount> red_points{};   ///< red samples by Face; a hole's rim may redden several
  std::uint64_t model_number = 0;             ///< grows whenever mesh and red change
  std::optional<NextView> next;    ///< where the rig goes, or the operator is asked to turn the tablet
  bool last_not_taken_up = false;  ///< kWaiting: a hint may settle the last scan
  std::optional<Checklist> checklist;
  bool signed_off = false;  ///< the verdict as it stands
  std::string signed_by;
  std::string void_signed_by;          ///< the last signature, where it no longer holds; else empty
  std::string void_since;              ///< what changed first since then
  std::set<std::string> lost_records;  ///< kinds, in words (session_faults.h); empty: none
  bool damage_found = false;           ///< on opening: of a scan, in or out, or of the records
  std::filesystem::path package;       ///< of the session as it stands, made or found here; empty: none
  std::optional<Error> error;          ///< what ended the last run or job
  bool halted = false;                 ///< the emergency stop was pressed in the run or job that goes on
  /// The device was told to stop, or to be given back, and does not answer (device_patience.h).
  std::optional<Error> silence;
  std::string notice;  ///< what the operator should know; empty when a later scan has made it old
  TabletRecord record;
  /// Else the session could not be written to when `record` was said.
  bool record_kept = true;
  std::shared_ptr<const PinSet> pins;        ///< with the operator's labels; nothing while none are known
  std::shared_ptr<const DevicePanel> panel;  ///< of the device that was opened last
  /// Motors go to what the red map would do next, as far as it is known of the chosen device. A rig that the
  /// red map knows may have none that can be told where to go.
  bool is_driven = false;
  std::optional<RigCare> care;                          ///< of the chosen device, where it is a rig
  std::shared_ptr<const VerifyOutcome> verification;    ///< the last of this window
  std::shared_ptr<const CalibrateOutcome> calibration;  ///< likewise
  bool exists = false;                                  ///< the folder holds a session
  int profiles = 0;                                     ///< of the scan under way
  int broken_off_rows = 0;  ///< of scans in whose middle a program ended; the next run stores them
};

}  // namespace dubsar
