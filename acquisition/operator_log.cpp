// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/operator_log.h"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "formats/hint_json.h"
#include "formats/json_node.h"

namespace dubsar {

namespace {

constexpr const char* kHint = "pose hint";
constexpr const char* kHintWithdrawn = "pose hint withdrawn";
constexpr const char* kLock = "scan locked";
constexpr const char* kUnlock = "scan unlocked";
constexpr const char* kDropped = "scan dropped";
constexpr std::array<std::string_view, 5> kKinds{kHint, kHintWithdrawn, kLock, kUnlock, kDropped};

/// Of a lock that does not say its frame itself: as long as one locked scan stands, the model keeps its
/// frame.
std::int64_t frame_of_earlier(const SessionEvent& event, const OperatorWord& word) {
  std::set<std::int64_t> standing;
  for (const auto& [id, lock] : word.locked) {
    if (lock.stood) {
      standing.insert(lock.frame);
    }
  }
  return standing.size() == 1 ? *standing.begin() : event.number;
}

ScanLock read_lock(const JsonNode& root, const SessionEvent& event, const OperatorWord& word) {
  ScanLock lock;
  lock.model_from_scanner = root.at("model_from_scanner").transform();
  if (const auto frame = root.find("frame")) {
    const std::int64_t said = frame->integer(0, event.number);
    lock.frame = said > 0 ? said : event.number;
  } else {
    lock.frame = frame_of_earlier(event, word);
  }
  if (const auto beside = root.find("beside")) {
    for (const JsonNode& one : beside->items()) {
      const auto on = static_cast<int>(one.at("on").integer(0, std::numeric_limits<int>::max()));
      lock.beside_from_scanner[on] = one.at("on_from_scanner").transform();
    }
  }
  return lock;
}

Status read_event(const SessionEvent& event, OperatorWord& word) {
  const std::string where = "event " + std::to_string(event.number) + " of the session";
  const Result<JsonDocument> document = JsonDocument::parse(event.json, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const int id = static_cast<int>(root.at("id").integer(0, std::numeric_limits<int>::max()));
  std::optional<ScanLock> lock;
  std::optional<PoseHint> hint;
  if (event.kind == kLock) {
    lock = read_lock(root, event, word);
  } else if (event.kind == kHint) {
    const Result<HintFile> file = parse_hint(root.at("hint").text(), where);
    if (!file) {
      return std::unexpected(file.error());
    }
    hint = file->hint;
  }
  if (Status status = document->status("give the hint or the lock again"); !status) {
    return status;
  }
  if (hint) {
    word.hints[id] = std::move(*hint);
  } else if (lock) {
    word.locked[id] = std::move(*lock);
  } else if (event.kind == kDropped) {
    if (const auto locked = word.locked.find(id); locked != word.locked.end()) {
      locked->second.stood = false;
    }
  } else if (event.kind == kUnlock) {
    word.locked.erase(id);
  } else {
    word.hints.erase(id);
  }
  return {};
}

}  // namespace

Status check_scan_stands(const SessionStore& store, int id) {
  const auto scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const auto scan = std::ranges::find(*scans, id, &StoredScan::id);
  const std::string name = "scan " + std::to_string(id);
  if (scan == scans->end()) {
    return fail(ErrorKind::kUsage, "there is no " + name, store.folder().string(), "see dubsar session list");
  }
  if (scan->dropped) {
    return fail(ErrorKind::kUsage, name + " was taken out", store.folder().string(), "restore it first");
  }
  if (scan->damaged) {
    return bad_input(store.folder().string(), name + " is damaged", "bring it back from a copy");
  }
  return {};
}

Status record_hint(SessionStore& store, int id, const PoseHint& hint) {
  for (const int scan : {id, hint.on}) {
    if (Status stands = check_scan_stands(store, scan); !stands) {
      return stands;
    }
  }
  return store.append_event(kHint, nlohmann::ordered_json{{"id", id}, {"hint", hint_to_json(hint)}}.dump());
}

Status record_hint_withdrawn(SessionStore& store, int id) {
  return store.append_event(kHintWithdrawn, nlohmann::ordered_json{{"id", id}}.dump());
}

Status record_lock(SessionStore& store, int id, const ScanLock& lock) {
  if (Status stands = check_scan_stands(store, id); !stands) {
    return stands;
  }
  nlohmann::ordered_json json{
      {"id", id}, {"model_from_scanner", lock.model_from_scanner.row_major()}, {"frame", lock.frame}};
  json["beside"] = nlohmann::ordered_json::array();
  for (const auto& [on, on_from_scanner] : lock.beside_from_scanner) {
    json["beside"].push_back({{"on", on}, {"on_from_scanner", on_from_scanner.row_major()}});
  }
  return store.append_event(kLock, json.dump());
}

Status record_unlock(SessionStore& store, int id) {
  return store.append_event(kUnlock, nlohmann::ordered_json{{"id", id}}.dump());
}

OperatorLog operator_log_of(std::span<const SessionEvent> events) {
  OperatorLog log;
  for (const SessionEvent& event : events) {
    if (std::ranges::find(kKinds, event.kind) == kKinds.end()) {
      continue;
    }
    if (const Status read = read_event(event, log.word); !read) {
      log.damage.push_back(read.error());
    }
  }
  return log;
}

Result<OperatorLog> read_operator_log(const SessionStore& store) {
  const auto events = store.events();
  if (!events) {
    return std::unexpected(events.error());
  }
  return operator_log_of(*events);
}

}  // namespace dubsar
