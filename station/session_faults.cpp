// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_faults.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "formats/json_node.h"

namespace dubsar {

namespace {

/// By how the name of a row begins, the first that fits.
constexpr std::pair<std::string_view, std::string_view> kKinds[] = {
    {"events ", "what was done (a signature, or that a scan was taken out)"},
    {"documents row signed ", "what was signed"},
    {"documents row tablet", "the description of the tablet"},
    {"documents row red_map", "the verdict"},
    {"documents row checklist", "the verdict"},
    {"documents ", "a document of the session"},
    {"scans ", "the list of scans"},
    {"poses ", "where scans lie"},
    {"flags ", "which samples are left out"},
    {"files ", "checksums of files"},
};

std::string kind_of(std::string_view row) {
  for (const auto& [begins, kind] : kKinds) {
    if (row.starts_with(begins)) {
      return std::string(kind);
    }
  }
  return "records of another kind";
}

/// A rebuilding that could not name all that it lost says so in the record; one that brought all back ends
/// it.
bool lost_what_nothing_names(const SessionStore& store) {
  bool lost = false;
  const auto events = store.events();
  for (const SessionEvent& event : events ? *events : std::vector<SessionEvent>()) {
    const bool is_loss = event.kind == "records lost";
    if ((!is_loss && event.kind != "records brought back") || json_depth(event.json) > kMaxJsonDepth) {
      continue;
    }
    const auto what = nlohmann::json::parse(event.json, nullptr, false);
    const auto says = [&](const char* key) {
      return what.is_object() && what.contains(key) && what[key].is_boolean() && what[key].get<bool>();
    };
    lost = is_loss ? lost || says("more") : lost && !says("all");
  }
  return lost;
}

}  // namespace

std::set<std::string> lost_records(const SessionStore& store) {
  std::set<std::string> out;
  const auto rows = store.lost_rows();
  for (const std::string& row : rows ? *rows : std::set<std::string>()) {
    out.insert(kind_of(row));
  }
  if (lost_what_nothing_names(store)) {
    out.insert("records that nothing names");
  }
  return out;
}

std::string one_line(const std::set<std::string>& kinds) {
  std::string out;
  for (const std::string& kind : kinds) {
    out += (out.empty() ? "" : "; ") + kind;
  }
  return out;
}

bool may_have_been_taken_out(const StoredScan& scan) {
  return !scan.dropped && scan.remark.find("it may have been taken out") != std::string::npos;
}

std::string damage_of(const SessionStore& store, const StoredScan& scan) {
  for (const Error& damage : store.opening().damage) {
    if (scan.damaged && damage.where.ends_with(scan.file)) {
      return damage.what;
    }
  }
  return {};
}

}  // namespace dubsar
