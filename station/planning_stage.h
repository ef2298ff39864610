// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "archive/render_scene.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/red_map.h"
#include "core/result.h"
#include "core/rig.h"
#include "core/sample_states.h"
#include "core/scan_pose.h"
#include "planning/cleared_map.h"
#include "planning/red_targets.h"
#include "planning/tablet_on_stage.h"
#include "station/station_scan.h"
#include "station/tablet_flags.h"
#include "station/view_gain.h"
#include "triangulation/stitcher.h"

namespace dubsar {

/// The stage behind registration: leaves out what the placed scans show to be foreign in each other, keeps
/// the flags of all placed scans cleared against each other, makes the red map from them, and keeps the mesh
/// stitched. The operator waits for the red map, nobody for the mesh: stitching has a call of its own. The
/// online engine and the verb `plan` work through it, so that both give the same. One thread at a time.
class PlanningStage {
 public:
  /// Makes a scan known. It takes part once place() says that it is registered.
  void add(const StationScan& scan);

  /// Follows the poses: puts in what is newly registered, takes out what no longer is, moves what has moved.
  /// A scan with the very samples of another is that one: it is put in only when that one is taken out.
  /// `exact` moves every scan to its last digit; without it one that moved by less than a small part of µ
  /// stays, which keeps the online work small. Errors: kCancelled.
  Status place(const std::vector<ScanPose>& poses, bool exact, JobContext& job);

  /// The red map over what is placed.
  [[nodiscard]] Result<RedMap> red_map(const Rig* rig, JobContext& job);

  /// Scans in which the last place() found something that is not of the tablet, and left it out; by id.
  [[nodiscard]] const std::vector<ForeignFound>& foreign() const { return flags_.foreign(); }

  /// Registered scans that the last place() left out since another has their very samples; by id.
  [[nodiscard]] const std::vector<ScanCopy>& copies() const { return flags_.copies(); }

  /// How the one scan that came between the last two red maps did; nothing when none or several came.
  [[nodiscard]] const std::optional<ViewGain>& last_gain() const { return last_gain_; }
  /// All of them so far.
  [[nodiscard]] const std::vector<ViewGain>& gains() const { return gains_; }

  /// Brings the mesh up to what is placed, while nobody waits. Errors: kCancelled, and the stitcher's.
  Status stitch(JobContext& job);

  /// What the motors have to know of the tablet before they go to a placement: how it lies, after the turn
  /// by hand that the placement asks for. Nothing before a scan is placed that was driven to.
  [[nodiscard]] std::optional<StageScene> scene_for(const Rig& rig, const Placement& placement) const;

  /// Whether scene_for() is of the tablet as it lies: not where it was laid otherwise for a scan that is out
  /// again, or has no place.
  [[nodiscard]] bool knows_how_it_lies() const;

  /// Before a step that lifts the tablet: a view from its side, while it was scanned only once and the rig
  /// can look from there. Else nothing.
  [[nodiscard]] std::optional<NextView> before_lifting(const Rig& rig, const NextView& next) const;
  /// After a scan that was not taken up: the view of the tablet as it lies now that should have most in
  /// common with what is placed, by where the motors and the asked turns say that the scan is.
  [[nodiscard]] std::optional<NextView> after_miss(const Rig& rig, int id) const;
  /// After scans in a row that were not taken up, the last of them of the tablet as it lies now, and nothing
  /// to be had from looking at it so: the best view of it laid otherwise, with half of it known (of a view
  /// that is planned without a miss a third is), from elsewhere than those in vain.
  [[nodiscard]] std::optional<NextView> laid_otherwise(const Rig& rig, std::span<const int> in_vain,
                                                       JobContext& job) const;

  /// The view that a scan was taken from, as the tablet lies now: the very same while it lies as it did then,
  /// else the nearest that the rig and a turn by hand allow. Nothing of a scan that no motor was driven to.
  [[nodiscard]] std::optional<NextView> same_view(const Rig& rig, int id) const;

  /// Where a scan was taken from, where that is known.
  [[nodiscard]] std::optional<Placement> drive_of(int id) const;

  /// Whether a scan, placed or not, shows far more than all others that are placed do together: a hand is
  /// larger than most tablets.
  [[nodiscard]] bool shows_much_more(int id) const;

  /// The mesh of what is placed; stitches what is not stitched yet.
  [[nodiscard]] Result<Mesh> mesh(JobContext& job);
  /// What mesh() made of poses that do not fit each other, as warnings_of_places(). `names`: of any scans, by
  /// id.
  [[nodiscard]] std::vector<std::string> warnings_of_mesh(std::map<int, std::string> names) const;

  /// Red (and amber, excused) samples of the last red_map() in the model frame, for pictures of the mesh.
  /// Excused samples that hang in the air are left out, strays and others: they would make the picture of
  /// air; the red map lists them.
  [[nodiscard]] ColouredPoints red_points(const Mesh& mesh) const;

  /// What has become of the samples of a scan in the last red_map(); nothing when it is not placed.
  [[nodiscard]] std::optional<SampleStates> states(int id) const;

  /// The placed scans, by id, with their flags as cleared.
  [[nodiscard]] std::vector<PlacedScan> placed() const { return cleared_.scans(); }
  /// Which way the tablet lies in the model frame.
  [[nodiscard]] RigidTransform tablet_from_model(const Mesh& mesh) const;

 private:
  /// What is where, as far as the mesh knows.
  struct Placed {
    PlacedScan scan;
    Eigen::AlignedBox3f box_mm;  ///< of its samples, scanner frame
    bool stitched = false;
  };

  void take_out(int id);
  [[nodiscard]] std::optional<ViewGain> gain_of_new(std::span<const PlacedScan> scans) const;
  [[nodiscard]] std::optional<StageState> stage() const;
  /// The scan from which turns by hand are told, where a newer one has no place: who turned the tablet for
  /// that one would take them to go from how it lies now. Else nothing.
  [[nodiscard]] std::optional<int> turns_go_from() const;
  /// As placed; else by what the motors and the asked turns say.
  [[nodiscard]] std::optional<PlacedScan> where_driven(int id) const;

  std::map<int, StationScan> scans_;
  TabletFlags flags_;
  std::map<int, Placed> placed_;
  std::vector<ScanPose> poses_;  ///< that were followed last
  ClearedMap cleared_;
  Stitcher stitcher_;
  std::vector<SampleFlags> excused_flags_;  ///< of the last red map, by position in placed()
  RedTargets targets_;                      ///< of the last red map
  std::vector<NextView> proposed_;          ///< by the last red map
  std::set<int> mapped_;                    ///< scans in the last red map
  std::optional<ViewGain> last_gain_;
  std::vector<ViewGain> gains_;
};

}  // namespace dubsar
