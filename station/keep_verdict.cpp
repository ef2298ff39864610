// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <nlohmann/json.hpp>

#include "acquisition/sign_off_log.h"
#include "formats/checklist_json.h"
#include "formats/json_node.h"
#include "formats/red_map_json.h"
#include "station/made_by.h"
#include "station/results.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

constexpr const char* kChecklist = "checklist";
constexpr const char* kSignOff = "sign_off";

/// Pages that show another one are taken back first.
Status keep_red_map(SessionStore& store, const RedMap& red_map) {
  const std::string text = red_map_to_json(red_map);
  const auto before = store.load_document("red_map");
  if (before && *before && **before != text) {
    if (Status taken = take_pages_back_once(store, "the verdict was worked out anew", kPlan); !taken) {
      return taken;
    }
  }
  return store.save_document("red_map", text);
}

Status keep_checklist(SessionStore& store, const Checklist& checklist) {
  return store.save_document(kChecklist, checklist_to_json(checklist));
}

/// What it says of more than the moment in which the disk was looked at. Null where it is no checklist.
nlohmann::json lasting_part(const std::string& checklist) {
  nlohmann::json out = json_depth(checklist) <= kMaxJsonDepth
                           ? nlohmann::json::parse(checklist, nullptr, false)
                           : nlohmann::json();
  if (!out.is_object()) {
    return {};
  }
  for (const char* of_the_moment : {"disk_free_gib", "store_checked", "store_files"}) {
    out.erase(of_the_moment);
  }
  return out;
}

}  // namespace

Status keep_verdict(SessionStore& store, const RedMap& red_map, const Checklist& checklist) {
  if (Status noted = note_judged(store); !noted) {
    return noted;
  }
  if (Status kept = keep_red_map(store, red_map); !kept) {
    return kept;
  }
  return keep_checklist(store, checklist);
}

Status keep_verdict(SessionStore& store, Results& results, const JobContext& job) {
  // The checklist at once, as yet without a signature: to hold one against the red map takes every grid to be
  // read, and whoever stops that has a checklist of this red map all the same.
  results.checklist.sign_off.reset();
  if (Status kept = keep_verdict(store, results.red_map, results.checklist); !kept) {
    return kept;
  }
  Result<SignOffLog> signed_off = read_sign_offs(store, job);
  if (!signed_off) {
    return std::unexpected(signed_off.error());
  }
  if (signed_off->sign_offs.empty()) {
    return {};
  }
  results.checklist.sign_off = std::move(signed_off->sign_offs.back());
  return keep_checklist(store, results.checklist);
}

Result<bool> keep_checklist_anew(SessionStore& store, const Checklist& checklist) {
  const Result<std::optional<std::string>> before = store.load_document(kChecklist);
  if (!before) {
    return std::unexpected(before.error());
  }
  nlohmann::json was = *before ? lasting_part(**before) : nlohmann::json();
  nlohmann::json is = lasting_part(checklist_to_json(checklist));
  if (was == is) {
    return false;
  }
  if (const Status kept = keep_checklist(store, checklist); !kept) {
    return std::unexpected(kept.error());
  }
  if (was.is_object()) {
    was.erase(kSignOff);
  }
  is.erase(kSignOff);
  return was != is;
}

}  // namespace dubsar
