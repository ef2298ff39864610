// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/engine.h"

#include <algorithm>
#include <chrono>
#include <ctime>
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
};
struct ScanToRegister {
  StationScan scan;
  bool last_of_batch = true;  ///< false for stored scans that a resumed session goes through again
};
struct ScanToPlan {
  StationScan scan;
  std::vector<ScanPose> poses;
  bool last_of_batch = true;
};
/// The planner's answer to an automatic run: where to next, or that there is nothing more to do.
using NextStep = std::optional<NextView>;

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

}  // namespace

struct Engine::Impl {
  EngineOptions options;
  EventSink sink;

  std::optional<SessionStore> store;
  std::optional<RangeSource> source;
  std::optional<Rig> rig;
  std::vector<StationScan> resumed;   ///< of an existing session
  std::set<std::string> known_files;  ///< a replayed file that is stored already is not stored again
  int placement_offset = 0;           ///< a resumed session starts with a lifted tablet
  bool drives = false;                ///< automatic, and the device can be placed

  BoundedQueue<RawScan> to_store{kQueueLength};
  BoundedQueue<ScanToRegister> to_register{kQueueLength};
  BoundedQueue<ScanToPlan> to_plan{kQueueLength};
  BoundedQueue<NextStep> to_device{1};

  Registrar registrar;
  PlanningStage planning;
  std::vector<StationScan> all_scans;  ///< of the planning thread; read by finish() after it has ended

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
    to_store.close();
    to_device.close();
  }
  bool failed() {
    const std::scoped_lock lock(mutex);
    return first_error.has_value();
  }

  Status open(JobContext& job);
  Status load_resumed(JobContext& job);
  void acquire(JobContext& job);
  bool take_scan(JobContext& job);
  void keep_stored();
  void register_all(JobContext& job);
  void plan_all(JobContext& job);
  Result<EngineResult> finish(JobContext& job);
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
  return load_resumed(job);
}

/// Takes the next scan of the device. False when there is none, or the run is over.
bool Engine::Impl::take_scan(JobContext& job) {
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
      to_store.push({std::move(*partial), std::nullopt});
    }
    // A bad file of a folder does not stop the others.
    return source->capabilities().finite && grid.error().kind == ErrorKind::kBadInput;
  }
  if (!grid) {
    give_up(grid.error());
    return false;
  }
  if (!*grid) {
    return false;
  }
  if (!(*grid)->source.empty() && known_files.contains((*grid)->source)) {
    return true;
  }
  if (flagger) {
    flagger->finish(**grid, flags);
  }
  if ((*grid)->nominal) {
    (*grid)->nominal->placement += placement_offset;
  }
  const bool streamed = flagger.has_value() && flags.size() == (*grid)->size();
  return to_store.push({std::move(**grid), streamed ? std::optional(std::move(flags)) : std::nullopt});
}

void Engine::Impl::acquire(JobContext& job) {
  // A device without an end, and nobody to ask for the next placement, gives one scan.
  const bool endless = !source->capabilities().finite && !drives;
  const int limit = options.max_scans > 0 ? options.max_scans : endless ? stored_count + 1 : 0;
  bool first = resumed.empty();
  for (int taken = stored_count; limit == 0 || taken < limit; ++taken) {
    if (job.cancelled()) {
      give_up({ErrorKind::kCancelled, "stopped", {}, {}});
      break;
    }
    if (drives && !first) {
      const std::optional<NextStep> step = to_device.pop();
      if (!step || !*step) {
        break;
      }
      emit(NextPlacement{**step});
      if (const Status placed = source->place(*(*step)->placement); !placed) {
        const std::scoped_lock lock(mutex);
        device_error = placed.error();
        break;
      }
    }
    first = false;
    if (!take_scan(job)) {
      break;
    }
  }
  to_store.close();
}

void Engine::Impl::keep_stored() {
  while (std::optional<RawScan> raw = to_store.pop()) {
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
    to_register.push({prepare_scan(*id, std::move(raw->grid), options.pins, std::move(raw->flags)), true});
  }
  to_register.close();
}

void Engine::Impl::register_all(JobContext& job) {
  const PinSet* pins = options.pins ? &*options.pins : nullptr;
  const auto handle = [&](StationScan scan, bool last_of_batch) {
    ScanPose pose;
    {
      const StageClock timing = clock("registration");
      pose = registrar.add(scan.id, scan.measured, pins, job);
    }
    std::vector<ScanPose> poses = registrar.poses();
    emit(ScanPlaced{pose, poses});
    to_plan.push({std::move(scan), std::move(poses), last_of_batch});
  };
  for (std::size_t k = 0; k < resumed.size() && !job.cancelled(); ++k) {
    handle(std::move(resumed[k]), k + 1 == resumed.size());
  }
  while (std::optional<ScanToRegister> item = to_register.pop()) {
    if (!job.cancelled()) {
      handle(std::move(item->scan), item->last_of_batch);
    }
  }
  to_plan.close();
}

void Engine::Impl::plan_all(JobContext& job) {
  while (std::optional<ScanToPlan> item = to_plan.pop()) {
    all_scans.push_back(item->scan);
    planning.add(item->scan);
    if (job.cancelled() || failed() || !item->last_of_batch) {
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
      to_device.push(can_go_on ? NextStep(red_map->next.front()) : std::nullopt);
    }
    emit(RedMapChanged{std::move(*red_map)});
  }
  to_device.close();
}

Result<EngineResult> Engine::Impl::finish(JobContext& job) {
  if (first_error) {
    Error error = *first_error;
    if (error.kind == ErrorKind::kCancelled) {
      error = {ErrorKind::kCancelled, "stopped; " + std::to_string(stored_count) + " scans are stored",
               options.session.string(), "the same command goes on with them"};
    }
    return std::unexpected(error);
  }
  if (stored_count == 0) {
    return std::unexpected(
        device_error.value_or(Error{ErrorKind::kBadInput, "the device gave no scan", options.device,
                                    "check what stands before the scanner"}));
  }
  EngineResult result;
  {
    const StageClock timing = clock("final registration");
    if (const Status done = registrar.finalize(job); !done) {
      return std::unexpected(done.error());
    }
  }
  result.poses = registrar.poses();
  for (ScanPose& pose : result.poses) {
    const auto scan = std::find_if(all_scans.begin(), all_scans.end(),
                                   [&](const StationScan& s) { return s.id == pose.id; });
    if (scan != all_scans.end()) {
      pose.file = scan->file;
    }
  }
  if (const Status saved = store->save_poses(result.poses); !saved) {
    return std::unexpected(saved.error());
  }
  Mesh mesh;
  {
    const StageClock timing = clock("final planning and meshing");
    if (const Status placed = planning.place(result.poses, true, job); !placed) {
      return std::unexpected(placed.error());
    }
    Result<RedMap> red_map = planning.red_map(rig ? &*rig : nullptr, job);
    if (!red_map) {
      return std::unexpected(red_map.error());
    }
    result.red_map = std::move(*red_map);
    Result<Mesh> stitched = planning.mesh(job);
    if (!stitched) {
      return std::unexpected(stitched.error());
    }
    mesh = std::move(*stitched);
  }
  emit(RedMapChanged{result.red_map});
  return std::unexpected(Error{});
}

Result<EngineResult> Engine::run(JobContext& job) {
  Impl& impl = *impl_;
  if (const Status opened = impl.open(job); !opened) {
    return std::unexpected(opened.error());
  }
  {
    std::jthread planning([&] { impl.plan_all(job); });
    std::jthread registration([&] { impl.register_all(job); });
    std::jthread storing([&] { impl.keep_stored(); });
    impl.acquire(job);
  }
  return impl.finish(job);
}

}  // namespace dubsar
