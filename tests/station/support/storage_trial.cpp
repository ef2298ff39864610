// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/station/support/storage_trial.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <regex>
#include <set>
#include <stdexcept>

#include "acquisition/session_store.h"
#include "tests/support/in_child.h"

namespace dubsar::test {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScans = "3";

/// The numbers in "scan 7 stored".
std::set<int> reported_scans(const std::string& log) {
  std::set<int> out;
  static const std::regex kLine("scan ([0-9]+) stored");
  for (std::sregex_iterator it(log.begin(), log.end(), kLine), end; it != end; ++it) {
    out.insert(std::stoi((*it)[1]));
  }
  return out;
}

bool is_dropped(const SessionStore& store, int id) {
  const auto scans = store.scans();
  return scans &&
         std::ranges::any_of(*scans, [&](const StoredScan& scan) { return scan.id == id && scan.dropped; });
}

/// The head of the tables, so that SQLite can neither play the log beside them nor merge it when it closes.
void damage_tables(const fs::path& session) {
  const int left = in_child([&] {
    Result<SessionStore> store = SessionStore::open(session);
    ::_exit(store && store->append_event("left in the log") ? 0 : 1);
    return 2;
  });
  std::fstream file(session / "session.sqlite", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(16);  // pages of another size
  file.write("\x02\x00", 2);
  if (left != 0 || !file.flush()) {
    throw std::runtime_error("the session of a trial could not be damaged");
  }
}

}  // namespace

std::vector<WritingVerb> writing_verbs() {
  return {
      {"scan", {"scan", "--auto", "--max-scans", "2", "--device", "DEVICE", "--session", "SESSION"}, false},
      {"scan on", {"scan", "--auto", "--max-scans", "4", "--device", "DEVICE", "--session", "SESSION"}},
      {"register",
       {"register", "SESSION"},
       true,
       [](const SessionStore& store) {
         const auto poses = store.poses();
         return poses && poses->size() == 3;
       }},
      {"hint", {"session", "hint", "SESSION", "2", "--pose", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "--on", "1"}},
      {"lock", {"session", "lock", "SESSION", "REGISTERED"}},
      {"drop",
       {"session", "drop", "SESSION", "1", "--why", "blurred"},
       true,
       [](const SessionStore& store) { return is_dropped(store, 1); }},
      {"undo",
       {"session", "undo", "SESSION"},
       true,
       [](const SessionStore& store) { return is_dropped(store, 2); }},
      {"describe",
       {"session", "describe", "SESSION", "--museum-number", "BM 1"},
       true,
       [](const SessionStore& store) {
         const auto text = store.load_document("tablet");
         return text && *text && (*text)->find("BM 1") != std::string::npos;
       }},
      {"sign",
       {"session", "sign", "SESSION", "--name", "A. Reader", "--incomplete", "a trial"},
       true,
       [](const SessionStore& store) {
         const auto events = store.events();
         return events && std::ranges::find(*events, "signed", &SessionEvent::kind) != events->end();
       }},
      {"plan", {"plan", "SESSION"}},
      {"stitch", {"stitch", "SESSION", "-o", "FOLDER/model.ply"}},
      {"analyze", {"analyze", "SESSION/mesh/model.ply", "-o", "FOLDER/wedges.json"}},
      {"export", {"export", "SESSION", "--to", "FOLDER/package"}},
      {"repair", {"verify", "SESSION", "--repair"}, true, {}, true},
  };
}

StorageTrials::StorageTrials(fs::path folder, std::uint64_t seed)
    : folder_(std::move(folder)),
      scanned_(folder_ / "scanned"),
      device_("sim:?seed=" + std::to_string(seed) + "&size=14x11x8&spacing=0.55") {
  const Outcome scanned = run_command(
      {"scan", "--auto", "--max-scans", kScans, "--device", device_, "--session", scanned_.string()});
  const auto store = SessionStore::open(scanned_, SessionStore::Access::kReadOnly);
  if (scanned.status < 0 || scanned.status > 1 || !store) {
    throw std::runtime_error("the session for the trials was not scanned, status " +
                             std::to_string(scanned.status) + ", signal " + std::to_string(scanned.signal) +
                             ": " + scanned.err);
  }
  const std::vector<StoredScan> scans = store->scans().value();
  for (const StoredScan& scan : scans) {
    scans_.push_back(scan.id);
  }
  events_ = store->events().value().size();
  const std::vector<ScanPose> poses = store->poses().value();
  for (const ScanPose& pose : poses) {
    registered_ = pose.status == PoseStatus::kRegistered ? std::to_string(pose.id) : registered_;
  }
  if (registered_.empty()) {
    throw std::runtime_error("no scan of the session for the trials is registered: take another seed");
  }
}

TrialOutcome StorageTrials::run(const WritingVerb& verb, const Fault& fault) {
  const fs::path folder = folder_ / ("run" + std::to_string(runs_++));
  const fs::path session = folder / "session";
  fs::create_directories(folder);
  if (verb.on_a_session) {
    fs::copy(scanned_, session, fs::copy_options::recursive);
  }
  if (verb.damaged) {
    damage_tables(session);
  }
  const Arguments arguments = filled_in(verb.arguments, {{"SESSION", session.string()},
                                                         {"FOLDER", folder.string()},
                                                         {"DEVICE", device_},
                                                         {"REGISTERED", registered_}});
  TrialOutcome out = run_with_fault(arguments, folder, folder_ / "fault.log", fault);
  look(verb, folder, out);
  fs::remove_all(folder);
  return out;
}

void StorageTrials::look(const WritingVerb& verb, const fs::path& folder, TrialOutcome& out) const {
  const auto say = [&](const std::string& what) { out.faults.push_back(what); };
  const fs::path session = folder / "session";
  const Outcome& command = out.command;
  std::set<int> expected = reported_scans(command.err);
  if (verb.on_a_session) {
    expected.insert(scans_.begin(), scans_.end());
  }
  if (expected.empty() && !SessionStore::is_session(session)) {
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  const Result<SessionStore> store = SessionStore::open_or_create(session);
  out.open_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!store) {
    say("it does not open: " + store.error().line());
    return;
  }
  for (const Error& damage : verb.damaged ? std::vector<Error>() : store->opening().damage) {
    say("damage: " + damage.line());
  }
  const Result<std::vector<StoredScan>> scans = store->scans();
  if (!scans) {
    say(scans.error().line());
    return;
  }
  for (const int id : expected) {
    const bool listed = std::ranges::find(*scans, id, &StoredScan::id) != scans->end();
    const Result<RangeGrid> grid = store->load_grid(id);
    if (!listed || !grid) {
      say("scan " + std::to_string(id) + " was stored and is " +
          (listed ? grid.error().line() : "not listed"));
    }
  }
  if (!out.killed && command.status == 0 && verb.is_done && !verb.is_done(*store)) {
    say("it said that it was done, and the session does not show it");
  }
  JobContext job;
  const Result<VerifyReport> report = store->verify(job);
  if (!report) {
    say("it cannot be verified: " + report.error().line());
    return;
  }
  for (const Error& damage : report->damaged) {
    say("verify: " + damage.line());
  }
  for (const std::string& name : report->extra) {
    say("nobody's: " + name);
  }
  for (const std::string& name : verb.damaged ? std::vector<std::string>() : report->set_aside) {
    say("set aside: " + name);
  }
  const Result<std::vector<SessionEvent>> events = store->events();
  if (verb.on_a_session && (!events || events->size() < events_)) {
    say("its record is shorter than it was");
  }
}

}  // namespace dubsar::test
