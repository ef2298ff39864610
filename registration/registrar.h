// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <vector>

#include "core/job.h"
#include "core/pin_set.h"
#include "core/pose_hint.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "registration/pose_search.h"
#include "registration/relaxation.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What came of Registrar::lock_near().
enum class LockOutcome { kLocked, kElsewhere, kNotRegistered };

struct RegistrationOptions {
  ScanSurfaceOptions surface;
  PoseSearchOptions search;
  RelaxationOptions relaxation;
  std::size_t least_samples = 300;  ///< a scan with fewer that can be matched is not registered
  double most_unit_ratio = 30.0;    ///< scans whose sizes differ by more are in different units
  double least_size_mm = 0.5;       ///< nothing that is scanned is smaller …
  double most_size_mm = 5000.0;     ///< … or larger: the numbers are in another unit
  int final_rounds = 2;             ///< of pairwise ICP and relaxation in finalize()
};

/// The online model: scans come one by one, each is registered against all that are in place, and all are
/// relaxed together. A pose that is not certain is never accepted: the scan stays kUnsure or kFailed with its
/// reason and is tried again whenever the model has grown. The first scan is the model frame (with a nominal
/// pose, the model frame is its tablet frame), unless it shows much less than a later one that does not fit
/// it; scans that do not connect to it form groups of their own, and poses() reports those of the largest.
/// A copy, a scan with the very samples of another (core/scan_copies.h), is no second measurement: it lies
/// where that one does, with all that is said of it, and takes part in nothing, but for what the operator
/// says under its id. When that one is taken out the copy takes its place, where it stood. Keeps features of
/// each scan, not its grid. Not thread-safe; uses all cores inside. Same scans in the same order, same bytes.
class Registrar {
 public:
  explicit Registrar(const RegistrationOptions& options = {});
  ~Registrar();
  Registrar(Registrar&&) noexcept;
  Registrar& operator=(Registrar&&) noexcept;
  Registrar(const Registrar&) = delete;
  Registrar& operator=(const Registrar&) = delete;

  /// Registers a scan; one of the same id is replaced. `pins` may be null. The grid is not kept. When the job
  /// is cancelled the scan stays in, failed, and finalize() or a later add() tries it again.
  ScanPose add(int id, const std::shared_ptr<const RangeGrid>& grid, const PinSet* pins, JobContext& job);
  /// All scans, by id.
  [[nodiscard]] std::vector<ScanPose> poses() const;
  /// Takes a scan out; the others keep their poses, but for those that only it connected: they are tried
  /// without it, and are unsure when nothing else speaks for their pose. What it alone showed to be large is
  /// no measure for the others any more, and what a hint for it or on it kept outside is tried without. False
  /// when there is none of this id.
  bool remove(int id, JobContext& job);
  /// The operator's word. Locked: the scan stays exactly there, registered, whatever the surfaces say. Not
  /// locked: a hint, good to a few degrees and millimetres, from which the scan is fitted and verified; also
  /// unlocks. False when there is no such scan, the pose is not rigid, or the hint led to no verified pose.
  /// Others that it connects are tried at once; when the job is cancelled, finalize() tries them.
  bool set_pose(int id, const RigidTransform& model_from_scanner, bool locked, JobContext& job);
  /// The operator's word on how a scan lies to another; may come before either scan is there and stands until
  /// clear_hint(), also when the scan is taken out and added again; of a copy it is said of its original.
  /// Groups of scans that it spans are joined only where it says, and only when that pose verifies like any
  /// other; otherwise the scan is unsure, with the reason. Errors: kBadInput for points that settle nothing
  /// (point_pairs.h) or a pose that is not rigid, kUsage for a hint of a scan on itself or a copy of it, or
  /// for a locked scan.
  Status set_hint(int id, const PoseHint& hint, JobContext& job);
  /// What stood outside for it is tried without it, at once; when the job is cancelled, by finalize().
  void clear_hint(int id, JobContext& job);
  /// Locks a scan where it is, or unlocks it. False when there is none that could be registered. A scan with
  /// copies is fixed as long as one of them is locked; each of them says only of its own lock. What is
  /// unlocked stays where it is until finalize(), which asks the surfaces how surely it lies there.
  bool set_locked(int id, bool locked);
  /// Locks a registered scan where it is, when that is the pose to within what its surface leaves open.
  LockOutcome lock_near(int id, const RigidTransform& model_from_scanner);
  /// As add(), from a given pose: the scan is refined from there and verified against the others, and nothing
  /// else is looked for. Locked: it stays there, whatever the surfaces say; add such scans before the others.
  /// All poses that are given must be in one frame.
  ScanPose add_at(int id, const std::shared_ptr<const RangeGrid>& grid, const PinSet* pins,
                  const RigidTransform& model_from_scanner, bool locked, JobContext& job);
  /// Tries again what is not registered, measures all overlapping pairs anew from where the scans are,
  /// relaxes, and judges every scan once more. kCancelled when the job was stopped; the model is then as it
  /// was between two steps.
  Status finalize(JobContext& job);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dubsar
