// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/earlier_package.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/bag_check.h"
#include "formats/bag_text.h"
#include "formats/corrections_json.h"
#include "formats/files_below.h"
#include "formats/json_node.h"
#include "formats/same_bytes.h"
#include "formats/selections_json.h"
#include "station/package.h"
#include "station/package_content.h"
#include "station/package_source.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// A scan is stored once and never changes: its grid tells which session it is.
bool is_grid(const StampedFile& file) {
  return fs::path(file.name).extension() == ".grid";
}

Error lost(const std::string& what, const fs::path& package) {
  return {
      ErrorKind::kBadInput, what + ", and the package that lies here holds it", package.string(),
      "bring it back from a copy of the session (dubsar verify --repair --from COPY); where there is none, "
      "choose another folder: the package that lies here keeps it"};
}

Error not_as_written(const std::string& name, const std::string& what, const fs::path& package) {
  return {ErrorKind::kBadInput,
          "the package that lies here is not what was written (" + name + ": " + what + ")", package.string(),
          "see what differs (dubsar verify), choose another folder, or replace it with --force"};
}

std::int64_t number_of(const nlohmann::json& event, const char* key) {
  return event.is_object() && event.contains(key) && event[key].is_number_integer()
             ? event[key].get<std::int64_t>()
             : 0;
}
std::string text_of(const nlohmann::json& event, const char* key) {
  return event.is_object() && event.contains(key) && event[key].is_string() ? event[key].get<std::string>()
                                                                            : std::string();
}

/// An array; empty of a package without a list of events, which tells nothing of what the session once held.
/// One that is nested deeper than Dubsar writes it is none.
nlohmann::json packed_events(const fs::path& package) {
  const Result<std::string> text = read_whole_file(package / "data" / kPackedEvents, kMaxJsonBytes);
  if (!text || json_depth(*text) > kMaxJsonDepth) {
    return nlohmann::json::array();
  }
  nlohmann::json events = nlohmann::json::parse(*text, nullptr, false);
  return events.is_array() ? std::move(events) : nlohmann::json::array();
}

/// Under whatever number: what was recorded after a loss is numbered anew when a copy brings back what was
/// lost.
bool holds(const std::vector<SessionEvent>& events, const nlohmann::json& packed) {
  const std::string kind = text_of(packed, "kind");
  return std::ranges::any_of(events, [&](const SessionEvent& own) {
    return number_of(packed, "time_ns") == own.time_ns && kind == own.kind;
  });
}

/// The record of a session is only ever added to: what a package of it has and the session lacks was lost.
Status check_record(const fs::path& package, const fs::path& session) {
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  if (const std::vector<Error> damage = damage_of_record(*store); !damage.empty()) {
    return std::unexpected(
        lost("the session may have lost some of its record (" + damage.front().what + ")", package));
  }
  const Result<std::vector<SessionEvent>> kept = store->events();
  if (!kept) {
    return std::unexpected(kept.error());
  }
  for (const nlohmann::json& event : packed_events(package)) {
    if (!holds(*kept, event)) {
      return std::unexpected(lost("the session has lost of its record: " + text_of(event, "kind"), package));
    }
  }
  return {};
}

/// What a person said in the viewer, in the session and in a package of it.
struct WorkOfAPerson {
  const char* own;
  const char* packed;
  bool (*reads)(const fs::path& file);
};
constexpr WorkOfAPerson kWorkOfAPerson[] = {
    {kCorrectionsOfSession, kPackedCorrections,
     [](const fs::path& file) { return read_corrections(file).has_value(); }},
    {kSelectionsOfSession, kPackedSelections,
     [](const fs::path& file) { return read_selections(file).has_value(); }}};

/// With the session's own file gone or damaged the package may have the only one that is whole.
Status check_by_hand(const fs::path& package, const fs::path& session) {
  for (const WorkOfAPerson& work : kWorkOfAPerson) {
    std::error_code unknown;
    const fs::path own = session / work.own;
    const fs::path packed = package / "data" / work.packed;
    if (fs::exists(packed, unknown) &&
        (!fs::exists(own, unknown) || (!work.reads(own) && work.reads(packed)))) {
      return std::unexpected(
          lost("the session no longer has " + std::string(work.own) + " as it was stored", package));
    }
  }
  return {};
}

bool names_dubsar(const fs::path& package) {
  const Result<std::string> info = read_whole_file(package / "bag-info.txt", kMaxBagTextBytes);
  return info && is_written_by_dubsar(*info);
}

Status check_is_whole(const fs::path& package, JobContext& job) {
  const Result<BagReport> report = check_bag(package, job);
  if (!report) {
    return std::unexpected(report.error());
  }
  if (report->ok()) {
    return {};
  }
  // A file by its name tells more than a sum of all of them.
  const auto file = std::ranges::find_if(
      report->damaged, [](const Error& damage) { return damage.where.starts_with("data/"); });
  const Error& damage = file == report->damaged.end() ? report->damaged.front() : *file;
  return std::unexpected(not_as_written(damage.where, damage.what, package));
}

}  // namespace

Status check_is_package(const fs::path& folder) {
  std::error_code ignored;
  const fs::file_status lies = fs::symlink_status(folder, ignored);
  if (!fs::exists(lies) || (fs::is_directory(lies) && fs::is_empty(folder, ignored)) ||
      (is_bag(folder) &&
       (names_dubsar(folder) || fs::is_regular_file(folder / "data" / kPackedEvents, ignored)))) {
    return {};
  }
  return fs::is_symlink(lies)
             ? fail(ErrorKind::kUsage, "this is a link to what is not there", folder.string(),
                    "choose another folder, or remove the link yourself")
             : fail(ErrorKind::kUsage, "what lies there is no package of Dubsar, so it is not replaced",
                    folder.string(), "choose another folder, or remove it yourself");
}

Status check_is_of_session(const fs::path& package, const SessionStore& store) {
  const auto packed = packed_events(package);
  const Result<std::vector<SessionEvent>> own = store.events();
  const Result<std::vector<StoredScan>> scans = store.scans();
  if (packed.empty() || !own || !scans || (own->empty() && scans->empty())) {
    return {};  // nothing tells
  }
  const auto same_scan = [&](const StoredScan& scan) {
    const std::string grid = fmt::format("grids/{:03}.grid", scan.id);
    return have_same_bytes(package / "data/scans" / grid, store.folder() / grid);
  };
  if (std::ranges::any_of(packed, [&](const nlohmann::json& event) { return holds(*own, event); }) ||
      std::ranges::any_of(*scans, same_scan)) {
    return {};
  }
  return fail(ErrorKind::kUsage, "what lies there is the package of another session, so it is not replaced",
              package.string(), "choose another folder, or remove it yourself");
}

Status check_nothing_added(const fs::path& package, const DoneStamp& stamp) {
  std::set<std::string> written;
  for (const StampedFile& file : stamp.outputs) {
    written.insert(file.name.substr(file.name.find('/') + 1));  // "PACKAGE/data/README.txt"
  }
  const FoundBelow payload = everything_below(package / "data");
  if (!payload.unreadable.empty()) {
    return std::unexpected(payload.unreadable.front());
  }
  for (const fs::path& file : payload.files) {
    const std::string name = file.lexically_relative(package).generic_string();
    if (!written.contains(name)) {
      return std::unexpected(not_as_written(name, "somebody added it", package));
    }
  }
  return {};
}

Result<bool> is_earlier_package(const fs::path& package, const fs::path& session, const StampedWork& now,
                                JobContext& job) {
  const std::optional<DoneStamp> known = read_done_stamp(now.stamp(), "export");
  const auto is_here = [&](const StampedFile& file) {
    return std::ranges::find(now.inputs(), file) != now.inputs().end();
  };
  if (!known || !is_bag(package) || std::ranges::none_of(known->inputs, [&](const StampedFile& file) {
        return is_grid(file) && is_here(file);
      })) {
    return false;
  }
  // Not by the stamp's outputs: an export that was killed at its very end leaves the stamp of the package
  // that did not come, beside the one that is still there.
  if (const Status whole = check_is_whole(package, job); !whole) {
    return std::unexpected(whole.error());
  }
  // Rows of a scan that was not over are grids, too: they went when that scan was gone on with.
  const auto gone = std::ranges::find_if(known->inputs, [&](const StampedFile& file) {
    std::error_code ignored;
    return is_grid(file) && !is_here(file) && fs::exists(package / "data/scans/grids" / file.name, ignored);
  });
  if (gone != known->inputs.end()) {
    return std::unexpected(lost("the session no longer has " + gone->name + " as it was stored", package));
  }
  if (const Status by_hand = check_by_hand(package, session); !by_hand) {
    return std::unexpected(by_hand.error());
  }
  const Status record = check_record(package, session);
  return record ? Result<bool>(true) : std::unexpected(record.error());
}

Status check_is_not_packed(const fs::path& package, const fs::path& session, const StampedWork& now,
                           JobContext& job) {
  if (!is_bag(package) || !names_dubsar(package)) {
    return {};
  }
  const Result<bool> earlier = is_earlier_package(package, session, now, job);
  if (!earlier) {
    return std::unexpected(earlier.error());
  }
  if (*earlier) {
    return fail(
        ErrorKind::kUsage,
        "something lies there already: a package of this session, of an earlier state or made otherwise",
        package.string(),
        "bring it up to date with --update, choose another folder, or replace it with --force");
  }
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  if (!store || packed_events(package).empty() || !check_is_of_session(package, *store)) {
    return {};  // write_package() says what there is to say
  }
  if (const Status whole = check_is_whole(package, job); !whole) {
    return whole;
  }
  return fail(ErrorKind::kUsage,
              "something lies there already: a package of this session without the stamp that belongs to it, "
              "which tells of what state it is",
              package.string(), "choose another folder, or replace it with --force");
}

}  // namespace dubsar
