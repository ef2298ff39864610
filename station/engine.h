// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "archive/report.h"
#include "core/checklist.h"
#include "core/job.h"
#include "core/motion_limits.h"
#include "core/pin_set.h"
#include "core/red_map.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "core/stage_times.h"
#include "station/deliverables.h"
#include "station/event.h"
#include "station/operator_command.h"

namespace dubsar {

struct EngineOptions {
  std::string device;             ///< URI
  std::filesystem::path session;  ///< folder; made when it is not there, gone on with when it is
  bool automatic = false;         ///< drive the rig (or ask for hand turns) until conclusive
  int max_scans = 0;              ///< of the whole session; 0: no limit (40 when automatic and not paced)
  std::optional<PinSet> pins;
  std::optional<RigLimits> limits = {};         ///< narrower than the device's own, from a file
  std::string limits_file = {};                 ///< for what is said about them
  std::optional<Eigen::Vector3d> size_mm = {};  ///< of the tablet, where the operator gave it
  /// Somebody stands beside it: each turn by hand, and what follows a scan that was not taken up, waits for a
  /// ScanNow (event WaitsForOperator), as does all but the first scan of an endless device without motors.
  /// What is automatic waits so in any case, but not behind such a scan; only sim: turns its own tablet.
  bool paced = false;
  bool first_scan_waits = false;                     ///< of a paced run: so does its first scan
  bool yields = false;                               ///< to a window: what computes comes after it
  bool show_model = false;                           ///< send ModelChanged whenever the mesh has grown
  SettingWords settings = {};                        ///< of the device, over those that the session keeps
  std::vector<OperatorCommand> first_commands = {};  ///< as if posted before the first scan
  bool keep_half_scan = false;                       ///< as if KeepHalfScan had been posted
};

/// What a run of the engine leaves behind.
struct EngineResult {
  std::vector<ScanPose> poses;
  RedMap red_map;
  Checklist checklist;
  Deliverables files;
  StageTimes timings;
  /// What ended the run before it was through: the device failed, or scans that are not of the tablet came
  /// again and again. What came until then is kept.
  std::optional<Error> device_error;
};

/// The online engine: device → profiles and flags → store → registration → red map, next view, mesh. One
/// thread per stage, bounded queues between them; every stage takes the scans in order, so the result does
/// not depend on timing.
///
/// Cancelling the job stops it in good order: scans that were stored stay stored, a half-taken scan is given
/// up (unless it is to be kept: keep_half_scan, KeepHalfScan), and run() returns kCancelled. Going on later
/// is run() on the same session.
class Engine {
 public:
  Engine(EngineOptions options, EventSink sink);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] Result<EngineResult> run(JobContext& job);

  /// Asks for something: it is done between two scans, stored, and answered by an OperatorObeyed, or by a
  /// Notice that says why not. What comes while the device is opened, or before run(), is done once the
  /// session is read. From any thread, never from the event sink; returns at once. False when the engine
  /// already writes its final results, or has ended; of a ScanAgain, when it takes no more scans.
  bool post(OperatorCommand command);
  /// Behind run(): what was posted before a run that failed or was stopped came to it, moved out.
  [[nodiscard]] std::vector<OperatorCommand> take_unheeded();

  /// The emergency stop, from any thread; returns at once. Lasers go off and motors stop, wherever run() is;
  /// it then ends like one whose device has failed: what was scanned until then is kept. Of a device that is
  /// being opened no setting is put any more.
  void halt();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
