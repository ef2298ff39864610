// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/scan_set.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "acquisition/device_uri.h"
#include "acquisition/range_source.h"
#include "core/log.h"
#include "drivers/loader.h"
#include "formats/files_below.h"
#include "formats/pins_json.h"
#include "formats/rig_json.h"
#include "station/alike_remarks.h"
#include "station/pin_faults.h"
#include "station/session_drives.h"
#include "station/session_pins.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

void tell(const std::string& what, const ScanSetOptions& options) {
  if (!options.again) {
    log_warning(what);
  }
}

/// Keeps a scan in the set, or hands it on. Pins of a file are looked at: nobody has seen them on the scan.
Status keep(StationScan scan, const ScanSetOptions& options, const ScanVisitor& visit, ScanSet& set) {
  if (!options.pins_file.empty() && !options.again) {
    if (const auto fault = misplaced_tips(*set.pins, scan.id, *scan.measured, scan.file)) {
      tell(fault->line(), options);
    }
  }
  if (!visit) {
    set.scans.push_back(std::move(scan));
    return {};
  }
  StationScan& named = set.scans.emplace_back();
  named.id = scan.id;
  named.file = scan.file;
  return visit(set, std::move(scan));
}

Status load_session(const fs::path& path, const ScanSetOptions& options, const ScanVisitor& visit,
                    ScanSet& set, JobContext& job) {
  Result<SessionStore> store = SessionStore::open(path, options.access);
  if (!store) {
    return std::unexpected(store.error());
  }
  for (const Error& damage : store->opening().damage) {
    tell(damage.line(), options);
  }
  for (const std::string& note : store->opening().notes) {
    store->opening().damage.empty() ? log_info(note) : tell(note, options);
  }
  const auto scans = store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  if (!set.pins) {
    Result<std::optional<PinSet>> pins = session_pins(*store);
    if (!pins) {
      return std::unexpected(pins.error());
    }
    set.pins = std::move(*pins);
  }
  Result<std::optional<Rig>> rig = session_rig(*store);
  if (!rig) {
    return std::unexpected(rig.error());
  }
  set.rig = std::move(*rig);
  Result<OperatorLog> log = read_operator_log(*store);
  if (!log) {
    return std::unexpected(log.error());
  }
  for (const Error& damage : log->damage) {
    tell(damage.line(), options);
  }
  set.word = std::move(log->word);
  const Result<std::map<int, Placement>> drives = session_drives(*store);
  if (!drives) {
    return std::unexpected(drives.error());
  }
  Result<std::vector<ScanPose>> poses = store->poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  set.poses = std::move(*poses);
  std::size_t done = 0;
  for (const StoredScan& scan : *scans) {
    job.progress("reading scans", static_cast<double>(done++) / static_cast<double>(scans->size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    if (scan.dropped) {
      continue;
    }
    if (scan.damaged) {  // what is wrong with it was told above
      set.left_out.push_back(check_scan_stands(*store, scan.id).error());
      continue;
    }
    Result<RangeGrid> grid = store->load_grid(scan.id);
    if (!grid) {
      tell(grid.error().line(), options);
      set.left_out.push_back(grid.error());
      continue;
    }
    StationScan prepared = prepare_scan(scan.id, std::move(*grid), set.pins);
    if (const auto drive = drives->find(scan.id); drive != drives->end()) {
      prepared.drive = drive->second;
    }
    if (const Status kept = keep(std::move(prepared), options, visit, set); !kept) {
      return kept;
    }
  }
  job.progress("reading scans", 1.0);
  set.store = std::move(*store);
  return {};
}

/// A scan may go by another name than that of its file, as in a package: the file is what counts.
Status check_not_written_over(const fs::path& file, const ScanSetOptions& options) {
  for (const fs::path& output : options.outputs) {
    std::error_code not_there;
    if (!output.empty() && fs::equivalent(file, output, not_there)) {
      return fail(ErrorKind::kUsage, "a scan would be written over", output.string(),
                  "give the output a name of its own");
    }
  }
  return {};
}

Status load_folder(const fs::path& path, const ScanSetOptions& options, const ScanVisitor& visit,
                   ScanSet& set, JobContext& job) {
  DeviceUri uri;
  uri.scheme = "replay";
  uri.locator = path.string();
  if (!options.unit.empty()) {
    uri.options.emplace_back("unit", options.unit);
  }
  const DriverRegistry registry;
  Result<RangeSource> source = RangeSource::open(uri.text(), registry);
  if (!source) {
    return std::unexpected(source.error());
  }
  AlikeRemarks remarks;
  const double count = static_cast<double>(source->capabilities().scan_count.value_or(10));
  for (int read = 0;; ++read) {
    job.progress("reading scans", std::min(1.0, read / count));
    Result<std::optional<RangeGrid>> grid = source->next([](const RangeGrid&, int) {}, job);
    if (!grid && grid.error().kind == ErrorKind::kBadInput) {
      if (Status apart = check_not_written_over(grid.error().where, options); !apart) {
        return apart;
      }
      set.left_out.push_back(grid.error());  // a bad file does not stop the others, nor shift their numbers
      ++set.numbered;
      continue;
    }
    if (!grid) {
      return std::unexpected(grid.error());
    }
    if (!*grid) {
      break;
    }
    for (const std::string& remark : source->record().remarks) {
      if (const std::string line = remarks.add((*grid)->source, remark); !line.empty()) {
        tell(line, options);
      }
    }
    StationScan prepared = prepare_scan(set.numbered++, std::move(**grid), set.pins);
    grid->reset();
    std::error_code not_there;
    prepared.read_from = fs::absolute(source->record().file, not_there).lexically_normal();
    if (Status apart = check_not_written_over(source->record().file, options); !apart) {
      return apart;
    }
    if (const Status kept = keep(std::move(prepared), options, visit, set); !kept) {
      return kept;
    }
  }
  for (const std::string& line : remarks.rest()) {
    tell(line, options);
  }
  for (const Error& error : set.left_out) {
    if (!set.scans.empty()) {
      tell(error.line(), options);
    }
  }
  job.progress("reading scans", 1.0);
  return {};
}

/// Scans that were taken out, or cannot be read, are there.
Status tell_tips_of_no_scan(const ScanSet& set, const ScanSetOptions& options) {
  std::vector<int> ids;
  if (set.store) {
    const auto stored = set.store->scans();
    if (!stored) {
      return std::unexpected(stored.error());
    }
    std::ranges::transform(*stored, std::back_inserter(ids), &StoredScan::id);
  } else {
    ids.resize(static_cast<std::size_t>(set.numbered));
    std::iota(ids.begin(), ids.end(), 0);
  }
  if (const auto fault = tips_of_no_scan(*set.pins, ids, options.pins_file.string())) {
    tell(fault->line(), options);
  }
  return {};
}

}  // namespace

Result<std::optional<Rig>> session_rig(const SessionStore& store) {
  const auto text = store.load_document("rig");
  if (!text || !*text) {
    return std::optional<Rig>();
  }
  Result<Rig> rig = parse_rig(**text, (store.folder() / "session.sqlite").string() + " (rig)");
  return rig ? Result<std::optional<Rig>>(std::move(*rig)) : std::unexpected(rig.error());
}

Result<ScanSet> load_scan_set(const fs::path& path, const ScanSetOptions& options, JobContext& job) {
  return visit_scan_set(path, options, {}, job);
}

Result<ScanSet> visit_scan_set(const fs::path& path, const ScanSetOptions& options, const ScanVisitor& visit,
                               JobContext& job) {
  ScanSet set;
  if (const Status readable = check_folder_can_be_read(path); !readable) {
    return std::unexpected(readable.error());
  }
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    return fail(ErrorKind::kUsage, "there is nothing here", path.string(),
                "give a session or a folder of range grids");
  }
  if (!options.pins_file.empty()) {
    Result<PinSet> pins = read_pins(options.pins_file);
    if (!pins) {
      return std::unexpected(pins.error());
    }
    set.pins = std::move(*pins);
  }
  const Status loaded = SessionStore::is_session(path) ? load_session(path, options, visit, set, job)
                                                       : load_folder(path, options, visit, set, job);
  if (!loaded) {
    return std::unexpected(loaded.error());
  }
  if (set.scans.empty() && !(options.may_be_empty && set.is_session())) {
    return set.left_out.empty()
               ? bad_input(path.string(), "no scan in it", "give a session or a folder of range grids")
               : std::unexpected(set.left_out.front());
  }
  if (const Status told = options.pins_file.empty() ? Status() : tell_tips_of_no_scan(set, options); !told) {
    return std::unexpected(told.error());
  }
  return set;
}

}  // namespace dubsar
