// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <variant>

#include "acquisition/operator_log.h"
#include "acquisition/range_source.h"
#include "acquisition/session_store.h"
#include "core/keep_out.h"
#include "core/log.h"
#include "drivers/loader.h"
#include "formats/checklist_json.h"
#include "formats/pins_json.h"
#include "formats/red_map_json.h"
#include "formats/rig_json.h"
#include "planning/checklist.h"
#include "planning/sparse_flags.h"
#include "registration/registrar.h"
#include "station/bounded_queue.h"
#include "station/calibration_record.h"
#include "station/camera_watch.h"
#include "station/drives.h"
#include "station/intruders.h"
#include "station/known_scans.h"
#include "station/lock_places.h"
#include "station/planning_stage.h"
#include "station/scan_set.h"
#include "station/session_pins.h"
#include "station/unfinished_scan.h"
#include "triangulation/placed_precision.h"

#include "station/engine.h"

namespace dubsar {

/// Scans that wait between two stages: enough to keep both busy, few enough to bound the memory.
inline constexpr std::size_t kQueueLength = 2;
inline constexpr int kAutomaticScans = 40;

/// A scan as the device gave it.
struct RawScan {
  RangeGrid grid;
  std::optional<SampleFlags> flags;
  std::optional<Placement> drive;
  std::shared_ptr<UnfinishedScan> kept{};  ///< its rows on disk until it is stored
  std::string remark{};                    ///< of the device
};
/// Stands in the queue to registration for commands of the operator that wait beside it.
struct CommandsWait {};
using ToRegister = std::variant<StationScan, CommandsWait>;
struct ScanToPlan {
  std::optional<StationScan> scan;  ///< nothing: only the poses have changed
  std::vector<ScanPose> poses;
  bool plan_now =
      true;  ///< false for all but the last of the stored scans that a resumed session goes through again
  bool device_waits = false;        ///< the device waits for what to do after it
  bool resumed = false;             ///< of a run before this one
  std::optional<int> view_of{};     ///< a scan that is to be taken again, from where it was taken
  std::shared_ptr<void> thought{};  ///< of the command it comes from: let go of once its next step is known
};
/// Where to next.
struct Step {
  NextView view;
  StageScene scene;    ///< how the tablet will lie when the motors move
  bool again = false;  ///< the view that was scanned last once more; nothing else is set
  int retakes = -1;    ///< a scan that is to be taken again
};
/// The planner's answer to an automatic run: a step, or that there is nothing more to do.
using NextStep = std::optional<Step>;

/// What asking the device for a scan led to.
enum class Taken { kScan, kNothing, kEnd };

inline Error stopped() {
  return {ErrorKind::kCancelled, "stopped", {}, {}};
}

/// Adds the time of a scope to a stage.
class StageClock {
 public:
  StageClock(std::map<std::string, double>& seconds, std::mutex& mutex, std::string stage)
      : seconds_(seconds),
        mutex_(mutex),
        stage_(std::move(stage)),
        start_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    const std::scoped_lock lock(mutex_);
    seconds_[stage_] += spent.count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  std::map<std::string, double>& seconds_;
  std::mutex& mutex_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
};

/// The state of a run. What a stage thread alone touches is marked; the rest stands still while the threads
/// run, or is under the mutex. engine_open.cpp opens device and session, engine_taking.cpp has the thread
/// that takes the scans of the device, engine_stages.cpp the three behind it, engine_motion.cpp what moves,
/// engine_misses.cpp what is done about scans that are not taken up, engine_pace.cpp what waits for the
/// operator, engine_device.cpp what is set and seen of the device, engine_origin.cpp what the session keeps
/// of what it was scanned with, engine_commands.cpp what the operator asks for meanwhile, engine_results.cpp
/// what is made at the end, engine.cpp the order of it all.
struct Engine::Impl {
  EngineOptions options;
  EventSink sink;

  std::optional<SessionStore> store;
  std::optional<RangeSource> source;
  std::optional<Rig> rig;
  std::vector<StationScan> resumed;  ///< of an existing session
  KnownScans known_files;            ///< a replayed file whose scan is in the session is not stored again
  bool told_unit = false;            ///< that scans are in the session in another unit
  int placement_offset = 0;          ///< a resumed session starts with a lifted tablet
  std::map<int, Placement> drives_of_scans;  ///< once the pipeline runs written by the storing thread alone
  bool wait_for_plan = false;                ///< the session that goes on says first whether it needs more
  bool drives = false;                       ///< automatic, and the device can be placed
  bool waits_for_hands_alone = false;        ///< paced, but for scans that were not taken up
  bool begins_again = false;                 ///< the run was started for a ScanAgain
  bool is_open = false;                      ///< device and session are, and its scans were read

  struct Queues {
    BoundedQueue<RawScan> to_store{kQueueLength};
    BoundedQueue<ToRegister> to_register{kQueueLength};
    BoundedQueue<ScanToPlan> to_plan{kQueueLength};
    BoundedQueue<NextStep> to_device{1};
  };
  std::unique_ptr<Queues> queues;  ///< of the round that runs; replaced under the mutex

  Registrar registrar;
  PlanningStage planning;
  // Of the registering thread while it runs:
  std::map<int, std::string> names;          ///< original names by id
  std::map<int, PlacedPrecision> precision;  ///< of those that were entered
  std::set<int> taken_out;                   ///< by the operator, perhaps before they were placed
  OperatorWord word;
  std::optional<std::int64_t> lock_frame;   ///< of the locks that the model stands fast by
  std::map<int, std::string> contradicted;  ///< locked scans, as settle_locks() has it
  IntruderFinder intruders;

  // Of the acquiring thread, round after round:
  std::optional<Placement> present;  ///< where the device was last driven to; an arm is anywhere at first
  StageScene scene;                  ///< as the last step saw it
  int empty_scans = 0;               ///< in a row
  std::unique_ptr<CameraStream> stream;
  bool asked_once = false;  ///< the first scan of a paced run is asked for by running it
  bool at_start = false;    ///< a paced run stands where its first scan is taken from
  // Of the planning thread, round after round:
  std::vector<int> in_vain;     ///< scans in a row that were not taken up
  bool laid_otherwise = false;  ///< the tablet, for the last of them
  bool again = false;           ///< the scan that comes is of the same view as the one before
  NextStep asked_again;         ///< of the last of to_take_again
  std::set<int> taken_up;
  std::set<int> told_foreign;  ///< scans of which it was said that something is left out
  std::map<int, int> lies_as;  ///< placement by scan, of scans that motors were told of

  mutable std::mutex mutex;  ///< of what follows
  std::optional<Error> first_error;
  std::optional<Error> device_error;
  std::map<std::string, double> seconds;
  int stored_count = 0;
  std::optional<PinSet> pins;  ///< options.pins, and what the operator has labelled since
  std::deque<OperatorCommand> commands;
  bool takes_commands = true;  ///< until the final results are written
  bool takes_scans = true;     ///< until the device rests
  bool halt_asked = false;
  bool scan_asked = false;    ///< of a paced run: ScanNow since the last scan
  bool finish_asked = false;  ///< of a paced run: Finish
  bool keeps_half = false;    ///< KeepHalfScan
  std::vector<ChangeSetting> settings_asked;
  bool watch_asked = false;              ///< WatchCamera
  bool last_scan_taken_up = true;        ///< as registration has judged it
  std::optional<NextStep> changed_step;  ///< what the operator's commands made of the step that waits
  std::vector<int> to_take_again;        ///< by a ScanAgain, until a scan is begun for it; the last one first
  std::condition_variable pace;

  // What the tablet was scanned with stays as it is until a scan of this run is stored:
  std::optional<CalibrationFile> calibration;  ///< of the device, as its file stood when it was opened
  std::mutex origin_mutex;                     ///< of what follows, and of what the session keeps of it
  SettingWords settings;                       ///< of the device, that were changed
  bool origin_kept = false;                    ///< a scan of this run is in the session
  bool pins_kept = false;                      ///< options.pins are of scans that the session has

  std::atomic<int> thoughts = 0;  ///< commands that are being obeyed, or whose next step is worked out

  void emit(const Event& event) const {
    if (sink) {
      sink(event);
    }
  }
  /// As many as were to be taken; while no thread of a round runs.
  [[nodiscard]] bool has_all_scans() const {
    return options.max_scans > 0 && stored_count >= options.max_scans;
  }
  StageClock clock(const char* stage) { return {seconds, mutex, stage}; }

  /// The first error ends the run; everything that is in the queues behind it still gets through. Only in a
  /// round: what fails while the session is opened is returned.
  void give_up(const Error& error) {
    bool half_comes = false;
    {
      const std::scoped_lock lock(mutex);
      if (!first_error) {
        first_error = error;
      }
      half_comes = keeps_half && error.kind == ErrorKind::kCancelled;
    }
    if (!half_comes) {  // else the acquiring thread closes it, once it has given what came
      queues->to_store.close();
    }
    queues->to_device.close();
  }
  bool failed() {
    const std::scoped_lock lock(mutex);
    return first_error.has_value();
  }

  Status open(JobContext& job);
  Status load_resumed(JobContext& job);
  void acquire(NextStep step, JobContext& job);
  void take_scans(NextStep step, JobContext& job);
  /// Before anything moves or lights for the next scan.
  void tell_start(const NextStep& step) const;
  /// Of a paced run: waits until the operator wants the scan; `step` follows what they ask for meanwhile.
  /// False when they want no more. engine_pace.cpp
  bool wait_for_operator(NextStep& step, const JobContext& job);
  /// A command of theirs may still change the step; under the mutex.
  [[nodiscard]] bool thinks_over() const { return !commands.empty() || thoughts > 0; }
  /// Thinks for as long as somebody holds it.
  std::shared_ptr<void> begin_thought();
  [[nodiscard]] bool must_wait(const NextStep& step) const;  ///< under the mutex
  void show_model(JobContext& job);
  // engine_device.cpp
  Status open_settings();  ///< puts what the session keeps and what the options say, and tells the panel
  void change_settings();  ///< those that were asked for; of the acquiring thread
  void tell_unset();       ///< likewise, where there is no device or no session for them
  bool show_camera();      ///< a frame, where one is asked for; false when none is
  void end_view();         ///< no frame is shown any more
  void tell_panel();
  // engine_origin.cpp
  /// Of a session without a scan: that it goes on with this device.
  Status keep_first_device();
  /// A setting that was put; under the device's name, whatever the session goes on with.
  Status keep_setting(const ChangeSetting& set);
  Status save_device();  ///< the settings, and that the session goes on with this device; under its mutex
  /// Rig, calibration, settings and pins, behind the first scan that this run has stored.
  void keep_origin();
  Status save_origin();  ///< under its mutex
  Status save_pins();    ///< under its mutex
  /// Rows that a program before this one left, where it scanned with the same device.
  Status keep_origin_of_left_rows();
  void keep_pins_of(KnownAs::Kind known);    ///< where the device has given what the session has
  [[nodiscard]] std::string scanned_with();  ///< for the pages; empty where the session does not know
  /// The rig that the session keeps: by it anyone works the verdict out again.
  [[nodiscard]] std::optional<Rig> kept_rig();
  /// Where no scan of this run is stored, its device must not change what is within reach.
  Status judge_by_kept_rig(EngineResult& result, JobContext& job);
  // engine_motion.cpp
  Status limit_rig();  ///< by the file, the pins and what is left then
  /// To where the first scan of this run is taken from.
  bool move_to_start(JobContext& job);
  /// False when it could not be done: nothing moves any more then.
  bool move_to(const Placement& target, const StageScene& on_stage, JobContext& job);
  void end_motion(Error error);  ///< notes what ended it
  void stop_motion_after_trouble(const JobContext& job);
  void end_halted();  ///< notes the emergency stop, if there was one
  [[nodiscard]] StageScene unseen() const;
  NextStep step_to(const RedMap& red_map) const;
  [[nodiscard]] NextStep step_again(int id) const;  ///< to where a scan was taken from
  /// What the operator has said of scans that are to be taken again; `as_before`: where to for that.
  void note_retakes(const ScanToPlan& item, const NextStep& as_before);
  /// Before what the red map says.
  NextStep retake_or(NextStep step, const ScanToPlan& item);
  void begin_retake(const NextStep& step);  ///< under the mutex: a scan begins
  // engine_misses.cpp
  /// Where to after a scan: by the red map when the scan was taken up; else the same view again, or one that
  /// has more in common with the others, then one of the tablet laid otherwise, then nothing more.
  NextStep step_after(int id, const std::vector<ScanPose>& poses, const RedMap& red_map, JobContext& job);
  /// Where the tablet was turned by hand since a scan was placed, only the motors' word says how it lies:
  /// whatever way it does.
  [[nodiscard]] StageScene unseen_and(const NextView& view) const;
  NextStep once_more();
  /// Whether the scans that were taken up until now have given way to others that lie in the same way on the
  /// stage: the two sets cannot both be the tablet.
  bool another_tablet(int id, const std::set<int>& before, const std::set<int>& now);
  Taken refuse_empty();  ///< of a scan without a sample
  Taken take_scan(const std::optional<Placement>& drive, JobContext& job);
  /// The rows of a scan that ended in its middle are as good as any.
  void keep_half(const std::optional<Placement>& drive, std::shared_ptr<UnfinishedScan> kept);
  /// What an earlier program had of a scan as it ended becomes a scan; before the session's are read.
  void take_up_left_scans();
  /// Of the pins that the run was given, where they cannot be in that scan.
  void tell_misplaced_pins(const StationScan& scan) const;
  Status store_left_rows(const RangeGrid& rows, const LeftScan& left);
  /// Whether one of that many scans, those that were stored last, has these rows.
  [[nodiscard]] bool is_among_newest(const RangeGrid& rows, std::size_t count) const;
  void keep_stored();
  bool is_known(const RangeGrid& grid);
  bool hand_to_store(RawScan scan);  ///< false when nothing is stored any more
  Status note_drive(int id, const Placement& drive);
  /// Onto the disk, and only then reported; false when it is not there.
  bool store_scan(int id, const RangeGrid& grid, const std::optional<Placement>& drive,
                  const std::string& remark);
  /// Into the model, as the operator's word on it has it. Failed where it would lie too far from its origin.
  ScanPose register_scan(const StationScan& scan, JobContext& job);
  void register_all(JobContext& job);
  /// Where pins were labelled while a scan waited to be registered: what of it is clay by what is known now.
  /// False where it is not on the disk.
  bool prepare_again(StationScan& scan);
  /// Takes out scans that show a hand or the like, that one included, and says so; then what they stood in
  /// the way of is tried again. engine_misses.cpp
  ScanPose set_intruders_aside(const StationScan& scan, ScanPose pose, std::vector<SetAside>& aside,
                               JobContext& job);
  void plan_all(JobContext& job);
  /// Of a paced run with a device that nothing drives and that has no end: ends it once nothing is left to
  /// do, but not before it has taken the scan that was asked for, nor one that is to be taken again.
  void end_conclusive(const RedMap& red_map, const ScanToPlan& item);
  void tell_foreign();  ///< what the planning stage has left out of scans, once of each
  std::vector<ScanPose> named_poses() const;
  [[nodiscard]] ScanPose judged(ScanPose pose) const;  ///< by what the model can hold
  // engine_commands.cpp
  void obey_commands(JobContext& job);  ///< those that wait, on the thread that owns the registrar
  /// The scans that came in by it, in place of what was there of them.
  Result<std::vector<StationScan>> obey(const OperatorCommand& command, std::string& what, JobContext& job);
  Result<StationScan> bring_back(int id, JobContext& job);
  /// Before what a command says is stored; one that is refused leaves them.
  void take_back_pages();
  [[nodiscard]] bool stands(int id) const;  ///< not where it was taken out, or there is no such scan
  Status read_word();                       ///< and by which locks the model still stands fast
  /// Fixes what is locked and is not fixed yet. True when that brought a scan into place.
  bool hold_locks(JobContext& job);
  /// Takes a stored scan in once more, as the pins are known now.
  Result<StationScan> enter_again(int id, JobContext& job);
  Result<std::vector<StationScan>> label_pins(const LabelPins& command, std::string& what, JobContext& job);
  [[nodiscard]] std::optional<PinSet> known_pins() const;
  /// What is to be undone is of the scans that there are now, not of one that comes before it is obeyed.
  void settle_undoing();
  /// Where the run failed or was stopped: of words that nobody heeds. None are taken any more.
  void tell_unheeded();
  bool close_commands();  ///< false when some came at the last moment: they are still to be obeyed
  Result<bool> run_round(NextStep step, EngineResult& result, JobContext& job);
  Result<EngineResult> run(JobContext& job);
  Status settle(EngineResult& result, JobContext& job);
  Status finish(EngineResult& result, JobContext& job);
};

}  // namespace dubsar
