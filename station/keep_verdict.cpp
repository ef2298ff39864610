// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/sign_off_log.h"
#include "formats/checklist_json.h"
#include "formats/red_map_json.h"
#include "station/results.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

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

}  // namespace

Status keep_verdict(SessionStore& store, const RedMap& red_map, const Checklist& checklist) {
  if (Status kept = keep_red_map(store, red_map); !kept) {
    return kept;
  }
  return store.save_document("checklist", checklist_to_json(checklist));
}

Status keep_verdict(SessionStore& store, Results& results, const JobContext& job) {
  if (Status kept = keep_red_map(store, results.red_map); !kept) {
    return kept;
  }
  Result<SignOffLog> signed_off = read_sign_offs(store, job);
  if (!signed_off) {
    return std::unexpected(signed_off.error());
  }
  results.checklist.sign_off.reset();
  if (!signed_off->sign_offs.empty()) {
    results.checklist.sign_off = std::move(signed_off->sign_offs.back());
  }
  return store.save_document("checklist", checklist_to_json(results.checklist));
}

}  // namespace dubsar
