// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "core/pin_set.h"
#include "core/sign_off.h"
#include "station/camera_watch.h"
#include "station/engine.h"
#include "station/live_state.h"
#include "station/scan_set.h"

namespace dubsar {

/// Of a job that was asked for and is dropped, since what went before was stopped or still goes on.
inline constexpr const char* kNotBegun =
    "what was asked for meanwhile was not begun; ask for it again once nothing else is under way";

/// One session for a skin that must never wait: the engine and every other long job run on a thread of their
/// own, one at a time, and what they say is kept as a LiveState. Whatever is asked for while none of them
/// takes commands starts the engine on the session. There is nothing to save: what was said to be stored is
/// stored.
class LiveSession {
 public:
  struct Options {
    std::string device;  ///< URI
    std::filesystem::path session;
    std::optional<PinSet> pins;
    bool is_device_asked = true;  ///< else a session that is there goes on with its own
    /// Ends the program, from another thread, where closing waits for a device that has not answered for
    /// kGivenUpAfter (device_patience.h). None: closing waits for as long as it takes.
    std::function<void(const Error&)> given_up{};
  };

  /// `on_change` is called on other threads whenever there is something new to show; of the profiles of a
  /// scan, once until look_at_growing() has seen them.
  LiveSession(Options options, std::function<void()> on_change);
  /// Stops what is under way in good order; what came of a scan under way is kept (of a device;
  /// a recorded scan is read again). A driver that does not come back: Options::given_up.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  [[nodiscard]] LiveState state() const;
  /// The scan under way from where a skin that has `known` rows of scan number `scan` must go on: some of
  /// those may have changed. Looking tells that what is there has been seen.
  [[nodiscard]] GrowingRows look_at_growing(std::uint64_t scan, int known);
  /// What the camera sees; nothing while nobody looks.
  [[nodiscard]] std::shared_ptr<const CameraView> camera() const;
  [[nodiscard]] std::string device() const;
  [[nodiscard]] const std::filesystem::path& folder() const { return options_.session; }
  /// For the next run.
  void set_device(std::string uri);

  /// What the folder holds. Where it holds no mesh of its scans, since it was left in the middle, the model
  /// is made again; whatever is asked for goes before that.
  void read();
  void scan_now();  ///< starts a run, or lets the one that waits go on
  /// Takes no more scans. Where no run is under way the verdict of what is stored is worked out and kept, as
  /// `dubsar plan` does.
  void finish();
  /// Cancels what is under way; of a folder that is read, only what was asked for meanwhile: a signature that
  /// was read by half would be none.
  void stop();
  /// The emergency stop, whatever is under way: lasers off, nothing moves, and no run begins by what was
  /// asked for before the next word. What was scanned is kept. The camera is looked through again once
  /// watch_camera(false) was said.
  void halt();
  /// Asks the engine, which is started for it where it does not run.
  void ask(OperatorCommand command);
  /// Looks through the camera, and opens the device for it where no run has it; to be said again and again
  /// while somebody looks, for a run may begin or end meanwhile. A run's scans go before it.
  void watch_camera(bool on);
  /// Of a rig that no run has: whether its laser is on while its camera is looked through.
  void light_camera(bool on);
  /// Of the open device; kept in the session, and put again whenever it goes on.
  void change_setting(const std::string& key, const std::string& word);
  void describe(const TabletRecord& record);
  void sign(const SignOff& wanted);
  /// `dubsar export --update`: all that leaves the storeroom, into that folder.
  void pack(const std::filesystem::path& to);
  /// `dubsar calibrate --verify`, and `dubsar calibrate`: each a job of its own, with its outcome in the
  /// state.
  void verify(const VerifyRequest& request);
  void calibrate(const CalibrateRequest& request);
  [[nodiscard]] bool busy() const { return busy_; }
  /// Likewise, with something that somebody waits for: whatever is asked for meanwhile has to wait.
  [[nodiscard]] bool is_occupied() const;

 private:
  enum class Job {
    kPlain,
    kReads,        ///< what the folder holds
    kMendsNothing  ///< what ended the job before is still to be read
  };
  void launch(std::function<void()> job, Job kind = Job::kPlain);
  [[nodiscard]] std::shared_ptr<JobContext> new_job();
  void do_what_was_asked();  ///< meanwhile; on the worker
  void drop_asked();         ///< under the mutex, and says so
  void keep_words();         ///< of scans that no run takes any more: into the session
  void take_word(Job kind);  ///< under the mutex: what ended the job before is known
  void take_later_word();    ///< likewise, of a word that goes before work that nobody waits for
  void mark_hint(const OperatorCommand& command);  ///< under the mutex
  void mark_hints();                               ///< under the mutex: those that are kept or waited for
  void show_hints(const SessionStore& store);      ///< under the mutex
  void cancel();                                   ///< under the mutex
  /// Under the mutex: no job has the device, or may yet come to it without another word.
  [[nodiscard]] bool is_away_from_device() const;
  void hurry();        ///< under the mutex: something was asked for, what nobody waits for ends
  void tell_device();  ///< under the mutex: from now on the device is waited for
  void take_device();  ///< of a job that begins: from whoever looks through its camera
  /// The job of work that nobody waits for; null where something else is wanted already.
  [[nodiscard]] std::shared_ptr<JobContext> begin_unasked();
  /// Such work: the model of these scans, or on the mesh that is shown what is red and
  /// excused.
  void rebuild_model(const SessionStore& store, const ScanSet& set, const std::vector<ScanPose>& poses,
                     bool red_alone);
  void run_engine(std::vector<OperatorCommand> first, bool first_scan_waits);
  /// For reading; it ends when this does (kCancelled).
  [[nodiscard]] Result<SessionStore> open_to_look();
  void read_folder();
  void take_own_device(const SessionStore& store);
  void look_for_broken_off();
  /// Of the signed session, where it was shown last; empty: in its usual place.
  void look_for_package(const std::filesystem::path& at);
  /// After a run that kept no verdict: what follows is not stopped with it. False where all ends.
  [[nodiscard]] bool begins_afterwards();
  /// Of such a run: whether the session holds what was shown last, and its signature.
  void verdict_after_break(const SessionStore& store);
  void show_scans(const SessionStore& store, const std::vector<StoredScan>& scans);  ///< under the mutex
  void show_verdict(const SessionStore& store);                                      ///< and who signed it
  void show_checklist(const SessionStore& store);
  void show_sign_offs(const SessionStore& store);
  /// What of the session is lost, and of its scans damaged; under the mutex. Told on every opening.
  void show_faults(const SessionStore& store, const std::vector<StoredScan>& scans);
  void note_last_scan(const SessionStore& store);     ///< likewise
  void show_signature(const CheckedSignOff& latest);  ///< under the mutex
  /// False where it is of other poses, or there is none.
  [[nodiscard]] bool show_stored_model(const SessionStore& store, const std::vector<ScanPose>& poses);
  void judge();
  Status judge_stored();
  void keep_record(const TabletRecord& record);
  /// Tries once more where the record could not be kept; false where it still cannot.
  bool keeps_refused_record();
  void hear(const Event& event);
  void progress(std::string_view stage, double fraction);
  LiveScan& scan_of(int id);                        ///< under the mutex
  void follow(const std::vector<ScanPose>& poses);  ///< under the mutex
  void show_grid(int id, const RangeGrid& measured, const RangeGrid& grid, const SampleFlags& flags);
  void show_model(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const ColouredPoints> red,
                  const RigidTransform& tablet_from_model);
  void look_after_rig();
  [[nodiscard]] SettingWords known_settings(const std::string& device);
  void keep_setting(const std::string& device, const std::string& key, const std::string& word);
  void end(const Status& status);  ///< of a job
  void changed() const;

  Options options_;
  std::function<void()> on_change_;
  mutable std::mutex mutex_;  ///< of what follows
  LiveState state_;
  GridPicture growing_;
  std::uint64_t growing_number_ = 0;
  std::optional<std::chrono::steady_clock::time_point> unseen_since_;  ///< of profiles
  std::shared_ptr<Engine> engine_;                                     ///< while it runs
  std::shared_ptr<JobContext> job_;
  /// Of the session that is opened to be shown: stopping a run does not break that off, closing does.
  JobContext looking_{[this](std::string_view stage, double fraction) { progress(stage, fraction); }};
  std::shared_ptr<JobContext> unasked_;  ///< work that nobody waits for, until the worker goes on
  std::function<void()> next_;           ///< a job that was asked for meanwhile
  std::deque<OperatorCommand> later_;    ///< asked for while a job ran that takes none
  std::set<int> hints_kept_;             ///< scans that the session holds a hint of
  std::string last_scan_;                ///< when it was stored, as in stored_times()
  bool closing_ = false;
  bool scan_later_ = false;    ///< likewise
  bool finish_asked_ = false;  ///< of the run under way
  bool looks_ = false;         ///< somebody, through the camera
  bool halted_ = false;        ///< until they look no more: looking lights a rig's laser
  std::optional<std::chrono::steady_clock::time_point> device_told_;  ///< to stop, or to be given back
  std::optional<TabletRecord> record_later_;                          ///< likewise
  std::optional<TabletRecord> record_told_;  ///< the last that the run under way was told of
  std::optional<SettingWords> settings_;     ///< of the device, kept and changed; nothing: not read yet
  std::shared_ptr<const CameraView> camera_;
  std::shared_ptr<CameraWatch> watch_;
  std::atomic<bool> busy_ = false;
  std::thread worker_;
};

}  // namespace dubsar
