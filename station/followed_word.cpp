// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/followed_word.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/pin_set.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "registration/point_pairs.h"
#include "station/made_by.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

constexpr const char* kFollowed = "poses follow";
constexpr const char* kFinished = "finished";
/// How the registrar begins its reason where a hint was tried and leads to no pose.
constexpr const char* kTriedHint = "the hint leads to no certain pose";

/// What stands of a scan by the record.
struct Said {
  std::string hint;  ///< as it was written down; empty without one
  std::string lock;
  std::string pins;  ///< its labels by hand
  bool out = false;
  friend bool operator==(const Said&, const Said&) = default;
};

struct Record {
  std::map<int, Said> now;
  std::map<int, Said> followed;  ///< as it stood when poses were last saved that follow it
  std::set<int> noted;           ///< scans that this version's note was of
  bool all_noted = false;        ///< there is one of all scans: the record tells, and nothing else

  [[nodiscard]] Said followed_of(int id) const {
    const auto known = followed.find(id);
    return known == followed.end() ? Said() : known->second;
  }
};

nlohmann::json parsed(const SessionEvent& event) {
  return nlohmann::json::parse(event.json, nullptr, false);
}

void note(const SessionEvent& event, Record& record) {
  const nlohmann::json json = parsed(event);
  const auto scans = json.is_object() ? json.find("scans") : json.end();
  if (event.kind == kFinished || scans == json.end() || !scans->is_array()) {
    record.followed = record.now;
    record.all_noted = record.all_noted || event.kind == kFollowed;
    return;
  }
  for (const nlohmann::json& scan : *scans) {
    if (scan.is_number_integer()) {
      const int id = scan.get<int>();
      record.followed[id] = record.now[id];
      record.noted.insert(id);
    }
  }
}

/// The event is of one scan; no tips take back what was said.
void note_labels(const SessionEvent& event, Record& record) {
  const Result<PinSet> labelled = parse_pins(event.json, event.kind);
  if (!labelled) {
    return;
  }
  for (const auto& [id, tips] : labelled->tips) {
    record.now[id].pins = tips.empty() ? std::string() : event.json;
  }
}

Result<Record> read_record(const SessionStore& store) {
  const auto events = store.events();
  if (!events) {
    return std::unexpected(events.error());
  }
  Record record;
  for (const SessionEvent& event : *events) {
    if (event.kind == kFollowed || event.kind == kFinished) {
      note(event, record);
      continue;
    }
    if (event.kind == "pins labelled") {
      note_labels(event, record);
      continue;
    }
    const bool hint = event.kind == "pose hint" || event.kind == "pose hint withdrawn";
    const bool lock = event.kind == "scan locked" || event.kind == "scan unlocked";
    const bool out = event.kind == "scan dropped" || event.kind == "scan restored";
    if (!hint && !lock && !out) {
      continue;
    }
    const nlohmann::json json = parsed(event);
    if (!json.is_object() || !json.contains("id") || !json["id"].is_number_integer()) {
      continue;  // read_operator_log() names it
    }
    Said& said = record.now[json["id"].get<int>()];
    if (hint) {
      said.hint = event.kind == "pose hint" ? event.json : std::string();
    } else if (lock) {
      said.lock = event.kind == "scan locked" ? event.json : std::string();
    } else {
      said.out = event.kind == "scan dropped";
    }
  }
  return record;
}

const ScanPose* pose_of(const std::vector<ScanPose>& poses, int id) {
  const auto found = std::ranges::find(poses, id, &ScanPose::id);
  return found == poses.end() ? nullptr : &*found;
}

Eigen::Vector3d center_mm(const RangeGrid& grid) {
  Eigen::Vector3d sum(0, 0, 0);
  double count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      sum += grid.point(i).cast<double>();
      ++count;
    }
  }
  return count > 0 ? (sum / count).eval() : sum;
}

bool follows_hint(const ScanSet& set, const std::vector<ScanPose>& poses, int id, const PoseHint& hint) {
  const ScanPose* scan = pose_of(poses, id);
  const ScanPose* on = pose_of(poses, hint.on);
  const auto loaded = std::ranges::find(set.scans, id, &StationScan::id);
  if (scan == nullptr || on == nullptr || loaded == set.scans.end()) {
    return true;  // what it is about is out, or was never judged
  }
  if (scan->status == PoseStatus::kRegistered && on->status == PoseStatus::kRegistered) {
    return agrees_with(hint, on->model_from_scanner.inverse() * scan->model_from_scanner,
                       center_mm(*loaded->grid));
  }
  return scan->reason.starts_with(kTriedHint) || on->reason.starts_with(kTriedHint);
}

/// What of it poses of an earlier version, that have no note, show that they were made without.
Said as_poses_have_it(const ScanSet& set, const std::vector<ScanPose>& poses, int id, Said now) {
  const ScanPose* pose = pose_of(poses, id);
  if (now.out && pose != nullptr) {
    now.out = false;
  }
  if (pose != nullptr && pose->status == PoseStatus::kRegistered && pose->locked != !now.lock.empty()) {
    now.lock = pose->locked ? "{}" : "";
  }
  const auto hint = set.word.hints.find(id);
  if (hint != set.word.hints.end() && !follows_hint(set, poses, id, hint->second)) {
    now.hint.clear();
  }
  return now;
}

}  // namespace

Status save_followed_poses(SessionStore& store, const std::vector<ScanPose>& poses,
                           const std::vector<int>& only) {
  const Result<std::vector<ScanPose>> before = store.poses();
  if (!before || poses_to_json(*before) != poses_to_json(poses)) {
    if (Status taken = take_pages_back_once(store, "the scans were registered anew", kPlan); !taken) {
      return taken;
    }
    if (Status noted = note_placed(store); !noted) {
      return noted;
    }
  }
  if (const Status saved = store.save_poses(poses); !saved) {
    return saved;
  }
  const Result<Record> record = read_record(store);
  if (!record) {
    return std::unexpected(record.error());
  }
  const bool behind = std::ranges::any_of(
      record->now, [&](const auto& entry) { return entry.second != record->followed_of(entry.first); });
  if (!behind && record->all_noted) {
    return {};
  }
  return store.append_event(
      kFollowed, only.empty() ? std::string("{}") : nlohmann::ordered_json{{"scans", only}}.dump());
}

Result<std::vector<std::string>> not_followed(const ScanSet& set) {
  if (!set.store) {
    return std::vector<std::string>();
  }
  const Result<Record> record = read_record(*set.store);
  const auto poses = set.store->poses();
  if (!record || !poses) {
    return std::unexpected(record ? poses.error() : record.error());
  }
  std::vector<std::string> out;
  for (const auto& [id, now] : record->now) {
    const bool noted = record->all_noted || record->noted.contains(id);
    const Said known = record->followed_of(id);
    Said before = known;
    if (!noted) {
      before = as_poses_have_it(set, *poses, id, now);
      before.hint = now.hint == known.hint ? now.hint : before.hint;
    }
    const std::string scan = "scan " + std::to_string(id);
    if (now.out != before.out) {
      out.push_back(scan + (now.out ? " has been taken out" : " has been put back"));
      continue;  // whatever else was said of it counts with it
    }
    if (now.out) {
      continue;
    }
    if (now.hint != before.hint) {
      out.push_back(now.hint.empty() ? "the hint for " + scan + " has been withdrawn"
                                     : scan + " has been given a hint");
    }
    if (now.lock != before.lock) {
      out.push_back(scan + (now.lock.empty() ? " has been unlocked" : " has been locked"));
    }
    if (now.pins != before.pins) {
      out.push_back("the pins of " + scan +
                    (now.pins.empty() ? " have no labels by hand any more" : " are labelled"));
    }
  }
  return out;
}

Result<std::string> not_followed_sentence(const ScanSet& set) {
  const Result<std::vector<std::string>> parts = not_followed(set);
  if (!parts) {
    return std::unexpected(parts.error());
  }
  std::string text;
  for (const std::string& part : *parts) {
    text += (text.empty() ? "the poses do not follow yet what was said: " : ", ") + part;
  }
  return text;
}

}  // namespace dubsar
