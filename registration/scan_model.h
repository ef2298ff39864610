// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/pose_hint.h"
#include "core/scan_copies.h"
#include "registration/last_judgement.h"
#include "registration/pin_advice.h"
#include "registration/registrar.h"
#include "registration/scan_step.h"
#include "registration/scan_stretch.h"
#include "registration/seen_pin.h"
#include "registration/self_similarity.h"
#include "registration/unit_check.h"

namespace dubsar {

/// The scans of a Registrar, the groups that they form and the pairs between them. A group is a set of scans
/// that are registered with each other in a frame of their own; a scan that is registered with nothing is a
/// group of one. A scan that came under several ids (scan_copies.h) is one measurement and takes part once,
/// under the first of them; the others are names of it, each with the frame that its file was in. A part of
/// another scan is placed like any other, but lies where that one does once both are in one group, and does
/// not count beside it.
class ScanModel {
 public:
  explicit ScanModel(const RegistrationOptions& options) : options_(options) {}

  /// Takes a scan in, as a group of its own; one of the same id is replaced. A null grid is an empty one.
  /// False when it is a copy of one that is in, and brings nothing that could place that one (pins that the
  /// operator labelled, the stage's word; `has_start`: a pose to start from): it stands where that one does.
  bool take_in(int id, const RangeGrid* grid, const PinSet* pins, bool has_start, JobContext& job);
  /// Takes a scan out. What only it connected is tried at once without it; where it has a copy, that takes
  /// its place. False when there is none.
  bool remove(int id, JobContext& job);
  /// After scans were taken out: where none that is left is about as large as what they were scaled by, they
  /// are scaled by the largest, and tried again; so is what was refused for its size beside those.
  void settle_scale(JobContext& job);
  /// Tries to join the scan's group with every other group. True when it joined one.
  bool join(int id, JobContext& job);
  /// Tries the scans outside the main group on what it has that is new to them, until no more join.
  void retry(JobContext& job);
  /// Takes out of the model what moved while it was scanned (scan_motion.h), as far as scans were joined
  /// since the last time: that shows with the others in place, and each that is in place may turn out to be
  /// the one.
  void put_out_faulty(JobContext& job);
  bool place(int as, const RigidTransform& model_from_as, bool locked, JobContext& job);
  Status finalize(JobContext& job);

  [[nodiscard]] ScanPose pose(int as) const;
  [[nodiscard]] std::vector<ScanPose> poses() const;

  // The operator's word (scan_model_hint.cpp). A hint stands from when it is given, whether its scans are in
  // or not: groups that it spans are joined by it and by nothing else.
  /// True when what another hint of this scan kept outside is to be tried without that one.
  bool set_hint(int id, const PoseHint& hint);
  /// What it kept outside is tried without it.
  void clear_hint(int id, JobContext& job);
  /// Before a scan is taken out: the hints for it and on it say nothing while it is. True when they kept
  /// something outside, which is to be tried without them.
  bool free_hints_of(int id);
  /// Places a scan that is in by its hint, taking it out of a place that the hint contradicts. True when it
  /// then stands where the hint says, verified.
  bool follow_hint(int id, JobContext& job);
  /// Locks a scan where it is, or unlocks it; a lock under another id of it stands.
  bool set_locked(int id, bool locked);
  /// Locks a scan where it is, when that is the pose.
  LockOutcome lock_near(int id, const RigidTransform& model_from_id);
  /// Gives a scan that was just entered its pose, to be refined and verified when it joins; nothing else is
  /// looked for. All such poses are in one frame.
  void enter_at(int id, const RigidTransform& model_from_scanner);

  // Ids of one measurement (scan_model_copies.cpp).
  /// The id under which the scan takes part: for a copy that of its original, else its own.
  [[nodiscard]] int stands_as(int id) const;
  /// Under which id it is locked: this one where it is.
  [[nodiscard]] std::optional<int> locked_as(int id) const;
  /// From the frame that the scan came in under this id to that of the id under which it takes part.
  [[nodiscard]] RigidTransform scan_from(int id) const;

 private:
  class WithoutForeign;

  /// The best poses of a search that settled nothing, relative to a scan of the group that was searched.
  struct Lead {
    int on = 0;
    RigidTransform on_from_scanner;
  };
  /// Another id of a scan.
  struct Copy {
    int of = 0;
    std::string file;
  };
  struct Scan {
    std::string file;
    std::optional<ScanPrint> print;
    ScanFeatures features;
    std::shared_ptr<const ScanSurface> whole;  ///< as it was entered, while something is left out of it …
    std::vector<std::uint8_t> left_out;        ///< … [cells of its fine grid]: a hand
    std::optional<NominalPose> nominal;
    std::vector<SeenPin> pins;
    bool pins_expected = false;
    double own_scale_mm = 0, own_spacing_mm = 0;
    /// Of one whose size is possible, and refused beside that of others: should they go.
    std::shared_ptr<const ScanSurface> waiting;
    bool usable = false;
    std::optional<bool> self_similar;                         ///< once it was asked for
    std::optional<std::vector<ReliefRepeat>> relief_repeats;  ///< likewise
    int group = 0;
    RigidTransform group_from_scanner;
    std::set<int> locked_as;   ///< its ids under which the operator fixed it
    bool given = false;        ///< joins from where it is or not at all
    std::string reason;        ///< why it does not join; empty when it has joined or was not tried
    std::string hint_reason;   ///< why its hint led to no pose
    std::string fault_reason;  ///< why it was taken out of the model when it was last in it
    bool has_moved = false;    ///< while it was scanned, as found when it was last looked at in the model
    std::string warning;       ///< what of it was off when all were in place, while it is there
    std::string suspicion;  ///< what unit it may be in when it joins nothing; empty for nothing in particular
    PoseStatus outcome = PoseStatus::kFailed;
    double rms_mm = 0, overlap = 0, stage_sigma_mm = 0;
    Matrix6d covariance = Matrix6d::Zero();
    std::set<int> tried_on;  ///< scans that it was searched on: their hypotheses are known to lead nowhere …
    std::vector<Lead> leads;  ///< … but for these, which a larger model may settle
    LastJudgement judgement;  ///< in its group

    [[nodiscard]] bool is_locked() const { return !locked_as.empty(); }
  };
  /// a < b.
  struct Pair {
    /// The same said of b and a.
    [[nodiscard]] Pair turned() const;

    RigidTransform measured_from;  ///< a_from_b that the measurement started at
    RigidTransform a_from_b;
    Eigen::Vector3d center_mm{0, 0, 0};
    Matrix6d information = Matrix6d::Zero();
    Footprint of_a, of_b;
  };

  /// What takes a scan out of the model.
  struct Fault {
    int gained = 0;  ///< samples that say so
    std::string reason;
  };

  /// As a group of its own, whatever it is a copy of.
  void enter(int id, const RangeGrid* grid, const PinSet* pins);
  /// Whether a copy may place the scan that it is of, which stands nowhere yet.
  [[nodiscard]] bool may_place(int original, int id, const RangeGrid& grid, const PinSet* pins,
                               bool has_start) const;
  /// True when the scan stays in under another id.
  bool leaves_a_copy(int id);
  /// One of its copies becomes the id under which the scan takes part.
  void hand_over(int from, int to);
  void set_scan_from(int id, const RigidTransform& from);
  /// Where the scan lies in its group, in the frame of this id.
  [[nodiscard]] RigidTransform group_from(int id) const;
  /// The pose, as which it takes part, of a scan that is placed so in the frame of this id.
  [[nodiscard]] RigidTransform scan_placed(int id, const RigidTransform& model_from_id) const;
  /// As long as the scan stays where it is, the pose of this id is this one to the last digit: what is signed
  /// goes by that. Where no sample tells it from where the scan lies.
  void keep_pose(int id, const RigidTransform& model_from_id);
  /// lock_near(), and the pose is kept. True where it is locked then.
  bool lock_at(int id, const RigidTransform& model_from_id);
  /// The hint for this id, in the frames in which its two scans take part.
  [[nodiscard]] PoseHint hint_for(int id) const;
  /// Finds which scans are parts of this one, and of which it is one.
  void find_parts(int id);
  /// The scan of these that this one is a part of, where it is not to stand by itself: the operator's locks
  /// hold.
  [[nodiscard]] std::optional<int> whole_among(const std::vector<int>& ids, int id) const;
  /// The scan of these whose samples these are: the whole that it is a part of, which is none of another, or
  /// itself.
  [[nodiscard]] int measured_as(const std::vector<int>& ids, int id) const;
  /// How many measurements these scans are.
  [[nodiscard]] std::size_t measurements(const std::vector<int>& ids) const;
  /// Those of these ids (ascending) whose samples tell something of this scan: not what has the same ones,
  /// its parts and what it is a part of, which would say that all is well with it; and no part beside its
  /// whole, which would say the same twice.
  [[nodiscard]] std::vector<int> heard_of(const std::vector<int>& ids, int id) const;
  /// Lays parts of scans where these lie.
  void place_parts(const std::vector<int>& ids);
  /// Enters a scan's surface, whose size agrees with that of the scans before it.
  void give_surface(Scan& scan, std::shared_ptr<const ScanSurface> surface, const ScanSize& size,
                    const ScanSize& before);
  /// The same of those that waited, where they agree with this size.
  void let_waiting_in(const ScanSize& now);
  /// Makes the surfaces of all scans anew for another scale; what was searched before is searched again.
  void rescale(double scale_mm);
  [[nodiscard]] std::vector<int> members(int group) const;  ///< ascending ids
  [[nodiscard]] bool is_all_apart() const;                  ///< no scan has joined another
  [[nodiscard]] int main_group() const;
  /// The largest first, which is the model; of equals the one whose scan came first, but for single scans
  /// that show much less than another.
  [[nodiscard]] std::vector<int> groups_by_size() const;
  [[nodiscard]] PoseHints hints_for(const Scan& scan, const std::vector<int>& group_ids) const;
  [[nodiscard]] ScanPins pins_of(int id) const;
  /// Why the scan does not join, with pins advised only where that helps: one that shows labelled pins has
  /// what pins can do. `advise`: and what is wrong with those.
  [[nodiscard]] std::string beside_pins(int id, std::string reason, bool advise) const;
  [[nodiscard]] std::vector<ModelScan> model_of(const std::vector<int>& ids) const;
  [[nodiscard]] std::vector<const ScanFeatures*> features_of(const std::vector<int>& ids) const;
  /// Looks for the scan's pose in the group: from its leads, and on the members that are new to it.
  bool join_group(int id, int group, JobContext& job);
  /// The same on these members of it alone, whatever a hint says of another scan.
  bool join_unhinted(int id, const std::vector<int>& ids, int group, JobContext& job);
  /// True when neither the scan nor what it was fitted to looks the same turned.
  bool shape_is_distinctive(int id, const ModelFit& fit, const std::vector<int>& group_ids);
  /// By how much the scan can be turned so that what speaks for the fit agrees as well: its own relief
  /// repeats, or that of every scan in whose relief it shows its pose.
  std::optional<double> relief_repeats(int id, const ModelFit& fit, const std::vector<int>& group_ids);
  /// True when none of the scans that the scan brings along contradicts the group that it joins.
  [[nodiscard]] bool groups_agree(int id, const RigidTransform& group_from_scanner,
                                  const std::vector<int>& group_ids) const;
  [[nodiscard]] const ScanSurface& whole_of(int id) const;
  /// Puts back what was left out of it.
  void make_whole(int id);
  /// The groups of the scan and of what it was fitted to become one.
  void connect(int id, const ModelFit& fit, bool by_stage, const std::vector<int>& fitted_ids, int group);
  /// Makes the scan a group of its own, and of each piece that nothing connects without it
  /// (scan_model_leave.cpp). True when there were such pieces.
  bool leave(int id);
  /// After a scan has left it: what that one said of the others is to count no more. They keep their poses
  /// until finalize(); one that is alone now is not measured against anything.
  void settle_without_one(int group, JobContext& job);
  /// The largest first, each ascending: scans that pairs, the stage or the operator's locks connect.
  [[nodiscard]] std::vector<std::vector<int>> pieces_of(int group) const;
  /// Measures the pairs that touch across pieces.
  void measure_between(const std::vector<std::vector<int>>& pieces);
  [[nodiscard]] std::optional<Pair> measured_pair(int a, int b) const;
  /// Measures the pairs (a < b), both cores over pairs, and keeps what holds.
  void measure_pairs(const std::vector<std::pair<int, int>>& pairs);
  /// True when the pair was measured from about where its scans are.
  [[nodiscard]] bool pair_is_fresh(int a, int b) const;
  /// Where it fails the poses stay as the fits left them.
  Status relax_group(int group, const JobContext& job);
  /// The same while scans come in: a failure is logged, and the next scan or finalize() tries again.
  void settle_group(int group, const JobContext& job);
  /// A scan among the others of its group that tell something of it.
  struct InGroup {
    PlacedSurface scan;
    std::vector<PlacedSurface> others;
    ModelFit fit;  ///< where it lies
  };
  /// Nothing where there are no others. May be asked of several scans at once.
  [[nodiscard]] std::optional<InGroup> in_group(int id);
  void judge(int id);
  [[nodiscard]] std::optional<Fault> fault_of(int id);
  /// Says what is wrong with scans of the main group although their poses are sure.
  void warn();
  void add_warning(int id, const std::string& said);
  /// Marks which of these are of another size or shape than the rest; of `sound` ones only, as what moved
  /// while it was scanned looks stretched or sheared, too.
  void warn_of_stretched(const std::vector<int>& ids, std::vector<int> sound);
  /// Marks which moved while they were scanned, by too little to be put out for it. Returns the others.
  [[nodiscard]] std::vector<int> warn_of_steps(const std::vector<int>& ids);
  /// Marks which show labelled pins elsewhere than the rest.
  void warn_of_pins(const std::vector<int>& ids);
  /// The scan where it lies, judged against these others alone; `ids` may hold it.
  [[nodiscard]] InGroup placed_among(int id, const std::vector<int>& ids) const;
  [[nodiscard]] std::string name_of(int id) const;  ///< for people
  /// Said of what is wrong with a scan where these, but for it, are one other only; empty where they are
  /// more.
  [[nodiscard]] std::string only_one(const std::vector<int>& ids, int id) const;
  /// The scan whose hint says how two groups lie to each other.
  [[nodiscard]] std::optional<int> hint_between(int group_a, int group_b) const;
  /// What the hint for this scan kept outside is outside for it no more. True when there was such a scan.
  bool free_hinted(int id);
  /// Whether no hint between the scan's group and the other contradicts the pose.
  [[nodiscard]] bool hints_hold(int id, int group, const RigidTransform& group_from_scanner) const;
  /// Joins the scan's group with the other from these poses alone, or says why not.
  bool join_from(int id, int group, const std::vector<RigidTransform>& starts, JobContext& job);
  bool join_by_hint(int hinted, JobContext& job);
  bool join_as_given(int id, int group, JobContext& job);

  /// A scan that sees so much more than the first one (by its scale) shows what the object's size is: the
  /// first was broken off, or saw a rim.
  static constexpr double kMuchLarger = 2.0;

  RegistrationOptions options_;
  double scale_mm_ = 0;
  double first_spacing_mm_ = 0;
  /// A relaxation was broken off, or a scan was taken out or unlocked since: finalize() makes up for it.
  bool is_unsettled_ = false;
  int next_group_ = 0;
  std::map<int, Scan> scans_;
  std::map<int, Copy> copies_;               ///< by id; no id is in both
  std::map<int, RigidTransform> scan_from_;  ///< scan_from() of the ids that came in another frame
  /// A pose that was given for an id, and its scan's group_from_scanner then.
  struct KeptPose {
    RigidTransform group_from_scanner, group_from_id;
  };
  std::map<int, KeptPose> kept_poses_;                   ///< by id
  std::map<std::pair<int, int>, RigidTransform> parts_;  ///< (part, whole): whole_from_part
  std::map<std::pair<int, int>, Pair> pairs_;
  std::set<int> unchecked_;        ///< joined, or with another that joined beside it, since put_out_faulty()
  std::map<int, PoseHint> hints_;  ///< by the id of the scan that they are for
};

}  // namespace dubsar
