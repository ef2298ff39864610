// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/engine.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "acquisition/range_source.h"
#include "acquisition/session_store.h"
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
#include "station/drives.h"
#include "station/planning_stage.h"
#include "station/scan_set.h"

namespace dubsar {

namespace {

/// Scans that wait between two stages: enough to keep both busy, few enough to bound the memory.
constexpr std::size_t kQueueLength = 2;
constexpr int kAutomaticScans = 40;

/// A scan as the device gave it.
struct RawScan {
  RangeGrid grid;
  std::optional<SampleFlags> flags;
  std::optional<Placement> drive;
};
struct ScanToPlan {
  StationScan scan;
  std::vector<ScanPose> poses;
  bool plan_now =
      true;  ///< false for all but the last of the stored scans that a resumed session goes through again
};
/// The planner's answer to an automatic run: where to next, or that there is nothing more to do.
using NextStep = std::optional<NextView>;

/// What asking the device for a scan led to.
enum class Taken { kScan, kNothing, kEnd };

Error stopped() {
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

std::string iso_time() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::vector<std::string> accuracy_sentences(const std::vector<ScanPose>& poses) {
  double worst_sigma_mm = 0;
  double worst_rms_mm = 0;
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      worst_sigma_mm = std::max(worst_sigma_mm, pose.sigma_mm);
      worst_rms_mm = std::max(worst_rms_mm, pose.rms_mm);
    }
  }
  return {fmt::format(
              "Where scans overlap, their surfaces lie within {:.1f} µm RMS of each other in the worst scan.",
              1000 * worst_rms_mm),
          fmt::format(
              "The predicted error of a scan's place is at most {:.1f} µm (one standard deviation), from the "
              "overlaps alone; the calibration of the scanner comes on top.",
              1000 * worst_sigma_mm)};
}

/// Pictures with four pixels to a sample: more would cost time and show nothing new. Small objects are still
/// drawn large enough to look at.
int picture_size_px(const std::vector<PlacedScan>& scans, const Mesh& mesh) {
  constexpr double kPxPerSample = 4;
  constexpr double kLeastPx = 480;
  constexpr double kMostPx = 1000;
  double spacing_mm = std::numeric_limits<double>::infinity();
  for (const PlacedScan& scan : scans) {
    spacing_mm = std::min(spacing_mm, scan.grid->spacing_mm);
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    box.extend(p);
  }
  const double longest_mm = box.isEmpty() ? 0.0 : static_cast<double>(box.sizes().maxCoeff());
  const double wanted_px = spacing_mm > 0 ? kPxPerSample * longest_mm / spacing_mm : kMostPx;
  return static_cast<int>(std::clamp(wanted_px, kLeastPx, kMostPx));
}

}  // namespace

struct Engine::Impl {
  EngineOptions options;
  EventSink sink;

  std::optional<SessionStore> store;
  std::optional<RangeSource> source;
  std::optional<Rig> rig;
  std::vector<StationScan> resumed;          ///< of an existing session
  std::set<std::string> known_files;         ///< a replayed file that is stored already is not stored again
  int placement_offset = 0;                  ///< a resumed session starts with a lifted tablet
  std::map<int, Placement> drives_of_scans;  ///< of the storing thread once the pipeline runs
  bool wait_for_plan = false;                ///< the session that goes on says first whether it needs more
  bool drives = false;                       ///< automatic, and the device can be placed

  struct Queues {
    BoundedQueue<RawScan> to_store{kQueueLength};
    BoundedQueue<StationScan> to_register{kQueueLength};
    BoundedQueue<ScanToPlan> to_plan{kQueueLength};
    BoundedQueue<NextStep> to_device{1};
  };
  std::unique_ptr<Queues> queues;  ///< of the round that runs

  Registrar registrar;
  PlanningStage planning;
  std::map<int, std::string> names;  ///< original names by id; of the registering thread while it runs

  std::mutex mutex;  ///< of what follows
  std::optional<Error> first_error;
  std::optional<Error> device_error;
  std::map<std::string, double> seconds;
  int stored_count = 0;

  void emit(const Event& event) const {
    if (sink) {
      sink(event);
    }
  }
  StageClock clock(const char* stage) { return {seconds, mutex, stage}; }

  /// The first error ends the run; everything that is in the queues behind it still gets through.
  void give_up(const Error& error) {
    {
      const std::scoped_lock lock(mutex);
      if (!first_error) {
        first_error = error;
      }
    }
    queues->to_store.close();
    queues->to_device.close();
  }
  bool failed() {
    const std::scoped_lock lock(mutex);
    return first_error.has_value();
  }

  Status open(JobContext& job);
  Status load_resumed(JobContext& job);
  void acquire(NextStep step, JobContext& job);
  Taken take_scan(const std::optional<Placement>& drive, JobContext& job);
  void keep_stored();
  void register_all(JobContext& job);
  void plan_all(JobContext& job);
  std::vector<ScanPose> named_poses() const;
  Result<bool> run_round(NextStep step, EngineResult& result, JobContext& job);
  Result<EngineResult> run(JobContext& job);
  Status settle(EngineResult& result, JobContext& job);
  Status finish(EngineResult& result, JobContext& job);
  Status keep_results(const EngineResult& result);
};

Engine::Engine(EngineOptions options, EventSink sink) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->sink = std::move(sink);
}
Engine::~Engine() = default;

Status Engine::Impl::load_resumed(JobContext& job) {
  const auto stored = store->scans();
  if (!stored) {
    return std::unexpected(stored.error());
  }
  for (const StoredScan& scan : *stored) {
    if (!scan.source.empty() && source->capabilities().finite) {
      known_files.insert(scan.source);
    }
    if (scan.dropped || scan.damaged) {
      continue;
    }
    job.progress("reading the session", static_cast<double>(scan.id) / static_cast<double>(stored->size()));
    Result<RangeGrid> grid = store->load_grid(scan.id);
    if (!grid) {
      emit(Notice{grid.error().line()});
      continue;
    }
    if (grid->nominal) {
      placement_offset = std::max(placement_offset, grid->nominal->placement + 1);
    }
    resumed.push_back(prepare_scan(scan.id, std::move(*grid), options.pins));
    if (const auto drive = drives_of_scans.find(scan.id); drive != drives_of_scans.end()) {
      resumed.back().drive = drive->second;
    }
  }
  stored_count = static_cast<int>(resumed.size());
  return {};
}

Status Engine::Impl::open(JobContext& job) {
  // The device first: a wrong URI must not leave an empty session behind.
  const DriverRegistry registry;
  for (const Error& rejected : registry.rejected()) {
    emit(Notice{"driver left out: " + rejected.line()});
  }
  Result<RangeSource> opened = RangeSource::open(options.device, registry);
  if (!opened) {
    return std::unexpected(opened.error());
  }
  source = std::move(*opened);
  rig = source->capabilities().rig;
  drives = options.automatic && source->capabilities().can_place;
  if (drives && options.max_scans <= 0) {
    options.max_scans = kAutomaticScans;
  }
  Result<SessionStore> session = SessionStore::open_or_create(options.session);
  if (!session) {
    return std::unexpected(session.error());
  }
  store = std::move(*session);
  for (const Error& damage : store->opening().damage) {
    emit(Notice{"damaged: " + damage.line()});
  }
  for (const std::string& note : store->opening().notes) {
    emit(Notice{note});
  }
  if (rig) {
    if (const Status saved = store->save_document("rig", rig_to_json(*rig)); !saved) {
      return saved;
    }
  }
  if (options.pins) {
    if (const Status saved = store->save_document("pins", pins_to_json(*options.pins)); !saved) {
      return saved;
    }
  } else if (const auto text = store->load_document("pins"); text && *text) {
    if (auto pins = parse_pins(**text, "pins of the session")) {
      options.pins = std::move(*pins);
    }
  }
  if (const auto text = store->load_document("drives"); text && *text) {
    if (auto known = parse_drives(**text, "drives of the session")) {
      drives_of_scans = std::move(*known);
    }
  }
  if (const Status loaded = load_resumed(job); !loaded) {
    return loaded;
  }
  wait_for_plan = drives && !resumed.empty();
  return {};
}

/// Takes the next scan of the device. kEnd when there is none, or the run is over; kNothing when this one
/// does not count, but others may follow.
Taken Engine::Impl::take_scan(const std::optional<Placement>& drive, JobContext& job) {
  std::optional<SparseFlagger> flagger;
  SampleFlags flags;
  const auto on_profile = [&](const RangeGrid& grid, int row) {
    if (!flagger && grid.spacing_mm > 0) {
      flagger.emplace(grid.cols, grid.spacing_mm);
    }
    if (flagger) {
      flagger->update(grid, flags);
    }
    emit(ProfileArrived{row, &grid, &flags});
  };
  Result<std::optional<RangeGrid>> grid = [&] {
    const StageClock timing = clock("acquisition");
    return source->next(on_profile, job);
  }();
  if (!grid && grid.error().kind != ErrorKind::kCancelled) {
    {
      const std::scoped_lock lock(mutex);
      device_error = device_error ? device_error : grid.error();
    }
    emit(Notice{grid.error().line()});
    // A device that stopped in mid-scan leaves profiles that are as good as any.
    if (std::optional<RangeGrid> partial = source->take_partial(); partial && partial->valid_count() > 0) {
      emit(Notice{"the half scan is kept"});
      queues->to_store.push({std::move(*partial), std::nullopt, drive});
    }
    // A bad file of a folder does not stop the others.
    const bool others = source->capabilities().finite && grid.error().kind == ErrorKind::kBadInput;
    return others ? Taken::kNothing : Taken::kEnd;
  }
  if (!grid) {
    give_up(grid.error());
    return Taken::kEnd;
  }
  if (!*grid) {
    return Taken::kEnd;
  }
  if (!(*grid)->source.empty() && known_files.contains((*grid)->source)) {
    return Taken::kNothing;
  }
  if (flagger) {
    flagger->finish(**grid, flags);
  }
  if ((*grid)->nominal) {
    (*grid)->nominal->placement += placement_offset;
  }
  const bool streamed = flagger.has_value() && flags.size() == (*grid)->size();
  const bool taken = queues->to_store.push(
      {std::move(**grid), streamed ? std::optional(std::move(flags)) : std::nullopt, drive});
  return taken ? Taken::kScan : Taken::kEnd;
}

/// `step` is where the scan before this round said to go next; nothing in the first round.
void Engine::Impl::acquire(NextStep step, JobContext& job) {
  // A device without an end, and nobody to ask for the next placement, gives one scan.
  const bool endless = !source->capabilities().finite && !drives;
  const int limit = options.max_scans > 0 ? options.max_scans : endless ? stored_count + 1 : 0;
  std::optional<Placement> drive = drives ? std::optional(Placement{}) : std::nullopt;
  // A session that goes on begins with a scan of how the tablet lies now, unless it is conclusive already.
  if (wait_for_plan) {
    const std::optional<NextStep> planned = queues->to_device.pop();
    if (!planned || !*planned) {
      queues->to_store.close();
      return;
    }
  }
  for (int taken = stored_count; limit == 0 || taken < limit;) {
    if (job.cancelled()) {
      give_up(stopped());
      break;
    }
    if (step) {
      emit(NextPlacement{*step});
      drive = step->placement;
      if (const Status placed = source->place(*drive); !placed) {
        emit(Notice{placed.error().line()});
        const std::scoped_lock lock(mutex);
        device_error = placed.error();
        break;
      }
    }
    const Taken got = take_scan(drive, job);
    if (got == Taken::kEnd) {
      break;
    }
    taken += got == Taken::kScan ? 1 : 0;
    if (drives) {
      step = queues->to_device.pop().value_or(std::nullopt);
      if (!step) {
        break;
      }
    }
  }
  queues->to_store.close();
}

void Engine::Impl::keep_stored() {
  while (std::optional<RawScan> raw = queues->to_store.pop()) {
    const StageClock timing = clock("storing");
    const Result<int> id = store->add_grid(raw->grid);
    if (!id) {
      give_up(id.error());
      continue;
    }
    {
      const std::scoped_lock lock(mutex);
      ++stored_count;
    }
    emit(ScanStored{*id, raw->grid.source, static_cast<std::int64_t>(raw->grid.valid_count())});
    StationScan scan = prepare_scan(*id, std::move(raw->grid), options.pins, std::move(raw->flags));
    scan.drive = raw->drive;
    if (scan.drive) {
      drives_of_scans[*id] = *scan.drive;
      if (const Status saved = store->save_document("drives", drives_to_json(drives_of_scans)); !saved) {
        give_up(saved.error());
      }
    }
    queues->to_register.push(std::move(scan));
  }
  queues->to_register.close();
}

void Engine::Impl::register_all(JobContext& job) {
  const PinSet* pins = options.pins ? &*options.pins : nullptr;
  const auto handle = [&](StationScan scan, bool plan_now) {
    ScanPose pose;
    {
      const StageClock timing = clock("registration");
      pose = registrar.add(scan.id, scan.measured, pins, job);
    }
    names[scan.id] = scan.file;
    pose.file = scan.file;
    std::vector<ScanPose> poses = named_poses();
    // Whatever ends the run, what it found until now is in the session.
    if (plan_now && !job.cancelled()) {
      if (const Status saved = store->save_poses(poses); !saved) {
        give_up(saved.error());
      }
    }
    emit(ScanPlaced{pose, poses});
    queues->to_plan.push({std::move(scan), std::move(poses), plan_now});
  };
  for (std::size_t k = 0; k < resumed.size() && !job.cancelled(); ++k) {
    handle(std::move(resumed[k]), k + 1 == resumed.size());
  }
  resumed.clear();
  if (job.cancelled()) {
    give_up(stopped());
  }
  while (std::optional<StationScan> scan = queues->to_register.pop()) {
    if (job.cancelled()) {
      give_up(stopped());
      continue;
    }
    handle(std::move(*scan), true);
  }
  queues->to_plan.close();
}

void Engine::Impl::plan_all(JobContext& job) {
  while (std::optional<ScanToPlan> item = queues->to_plan.pop()) {
    planning.add(item->scan);
    if (job.cancelled()) {
      give_up(stopped());  // the device waits for a next step that will not come
    }
    if (failed() || !item->plan_now) {
      continue;
    }
    const StageClock timing = clock("planning and meshing");
    if (const Status placed = planning.place(item->poses, false, job); !placed) {
      give_up(placed.error());
      continue;
    }
    Result<RedMap> red_map = planning.red_map(rig ? &*rig : nullptr, job);
    if (!red_map) {
      give_up(red_map.error());
      continue;
    }
    const bool can_go_on = !red_map->conclusive && !red_map->next.empty() && red_map->next.front().placement;
    if (drives) {
      queues->to_device.push(can_go_on ? NextStep(red_map->next.front()) : std::nullopt);
    }
    emit(RedMapChanged{std::move(*red_map)});
  }
  queues->to_device.close();
}

std::vector<ScanPose> Engine::Impl::named_poses() const {
  std::vector<ScanPose> poses = registrar.poses();
  for (ScanPose& pose : poses) {
    if (const auto name = names.find(pose.id); name != names.end()) {
      pose.file = name->second;
    }
  }
  return poses;
}

/// The final word on all scans that there are: poses, and the red map that follows from them.
Status Engine::Impl::settle(EngineResult& result, JobContext& job) {
  {
    const StageClock timing = clock("final registration");
    if (const Status done = registrar.finalize(job); !done) {
      return done;
    }
  }
  result.poses = named_poses();
  if (const Status saved = store->save_poses(result.poses); !saved) {
    return saved;
  }
  const StageClock timing = clock("final planning and meshing");
  if (const Status placed = planning.place(result.poses, true, job); !placed) {
    return placed;
  }
  Result<RedMap> red_map = planning.red_map(rig ? &*rig : nullptr, job);
  if (!red_map) {
    return std::unexpected(red_map.error());
  }
  result.red_map = std::move(*red_map);
  emit(RedMapChanged{result.red_map});
  return {};
}

/// Runs the pipeline from `step` until the device has no more, or until the online red map says that nothing
/// is left to do; then settles. True when the settled map still has something to do.
Result<bool> Engine::Impl::run_round(NextStep step, EngineResult& result, JobContext& job) {
  queues = std::make_unique<Queues>();
  {
    std::jthread planner([&] { plan_all(job); });
    std::jthread registration([&] { register_all(job); });
    std::jthread storing([&] { keep_stored(); });
    acquire(std::move(step), job);
  }
  if (first_error) {
    return std::unexpected(*first_error);
  }
  if (stored_count == 0) {
    return std::unexpected(
        device_error.value_or(Error{ErrorKind::kBadInput, "the device gave no scan", options.device,
                                    "check what stands before the scanner"}));
  }
  if (const Status settled = settle(result, job); !settled) {
    return std::unexpected(settled.error());
  }
  const bool goes_on = drives && !device_error && stored_count < options.max_scans &&
                       !result.red_map.conclusive && !result.red_map.next.empty() &&
                       result.red_map.next.front().placement;
  return goes_on;
}

/// Mesh, checklist, pictures and report of the settled scans.
Status Engine::Impl::finish(EngineResult& result, JobContext& job) {
  Mesh mesh;
  {
    const StageClock timing = clock("final planning and meshing");
    Result<Mesh> stitched = planning.mesh(job);
    if (!stitched) {
      return std::unexpected(stitched.error());
    }
    mesh = std::move(*stitched);
  }
  result.checklist =
      make_checklist(result.red_map, result.poses, planning.placed(), mesh, rig ? &*rig : nullptr);
  result.checklist.disk_free_gib = store->disk_free_gib();
  const Result<VerifyReport> whole = store->verify(job);
  result.checklist.store_whole = whole && whole->ok();
  for (const auto& [stage, spent] : seconds) {
    result.timings.push_back({stage, spent});
  }
  result.stored_scans = stored_count;
  result.device_error = device_error;

  const auto started = std::chrono::steady_clock::now();
  const ReportInput input{.title = options.session.filename().string(),
                          .tool_version = "Dubsar " DUBSAR_VERSION,
                          .when = iso_time(),
                          .device = options.device,
                          .model = mesh,
                          .red_map = result.red_map,
                          .checklist = result.checklist,
                          .scans = result.poses,
                          .red_points = planning.red_points(),
                          .tablet_from_model = planning.tablet_from_model(mesh),
                          .accuracy = accuracy_sentences(result.poses),
                          .calibration = {},
                          .not_measured = {"Wedges: they are not measured yet."},
                          .timings = result.timings,
                          .longest_px = picture_size_px(planning.placed(), mesh)};
  Result<Deliverables> files = write_deliverables(options.session, input, job);
  if (!files) {
    return std::unexpected(files.error());
  }
  result.files = std::move(*files);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
  result.timings.push_back({"pictures and report", spent.count()});
  return keep_results(result);
}

/// The verdict and what it rests on go into the session, so that anyone can work it out again.
Status Engine::Impl::keep_results(const EngineResult& result) {
  if (const Status s = store->save_document("red_map", red_map_to_json(result.red_map)); !s) {
    return s;
  }
  if (const Status s = store->save_document("checklist", checklist_to_json(result.checklist)); !s) {
    return s;
  }
  for (const std::filesystem::path* file :
       {&result.files.mesh, &result.files.six_views, &result.files.red_map, &result.files.report,
        &result.files.poses, &result.files.red_map_json}) {
    if (file->empty()) {
      continue;
    }
    if (const Status s = store->record_file(std::filesystem::relative(*file, options.session)); !s) {
      return s;
    }
  }
  return store->append_event(
      "finished", result.red_map.conclusive ? R"({"conclusive":true})" : R"({"conclusive":false})");
}

Result<EngineResult> Engine::Impl::run(JobContext& job) {
  if (const Status opened = open(job); !opened) {
    return std::unexpected(opened.error());
  }
  EngineResult result;
  const int resumed_count = stored_count;
  NextStep step;
  for (;;) {
    const Result<bool> goes_on = run_round(std::move(step), result, job);
    if (!goes_on) {
      return std::unexpected(goes_on.error());
    }
    if (!*goes_on) {
      break;
    }
    wait_for_plan = false;
    // How the tablet lies is known only once this run has scanned it.
    step = stored_count > resumed_count ? NextStep(result.red_map.next.front()) : std::nullopt;
  }
  if (const Status finished = finish(result, job); !finished) {
    return std::unexpected(finished.error());
  }
  return result;
}

Result<EngineResult> Engine::run(JobContext& job) {
  Result<EngineResult> result = impl_->run(job);
  if (!result && result.error().kind == ErrorKind::kCancelled) {
    const int stored = impl_->stored_count;
    return fail(ErrorKind::kCancelled,
                fmt::format("stopped; {} {} stored", stored, stored == 1 ? "scan is" : "scans are"),
                impl_->options.session.string(), "the same command goes on with what is there");
  }
  return result;
}

}  // namespace dubsar
