// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/made_by.h"

#include <optional>

#include "formats/json_node.h"
#include "formats/json_text.h"
#include "station/results.h"

namespace dubsar {

namespace {

constexpr const char* kRun = "run";  // as results.cpp keeps it
constexpr const char* kPrograms = "programs";
constexpr const char* kPlaced = "placed";
constexpr const char* kJudged = "judged";

/// The text that a document has under that key; empty where it has none.
std::string text_in(const SessionStore& store, const char* name, const char* key) {
  const Result<std::optional<std::string>> text = store.load_document(name);
  if (!text || !*text) {
    return {};
  }
  const Result<JsonDocument> document = JsonDocument::parse(**text, name);
  const std::optional<JsonNode> value = document ? document->root().find(key) : std::nullopt;
  return value && value->is_text() ? value->text() : std::string();
}

Status note(SessionStore& store, std::string MadeBy::*who) {
  const Result<std::optional<std::string>> run = store.load_document(kRun);
  if (!run) {
    return std::unexpected(run.error());
  }
  MadeBy known = made_by(store);
  if (!*run || known.*who == program_name()) {
    return {};
  }
  known.*who = program_name();
  return store.save_document(kPrograms, text_of({{kPlaced, known.placed}, {kJudged, known.judged}}));
}

}  // namespace

MadeBy made_by(const SessionStore& store) {
  MadeBy out;
  out.scanned = text_in(store, kRun, "program");
  const std::string placed = text_in(store, kPrograms, kPlaced);
  const std::string judged = text_in(store, kPrograms, kJudged);
  out.placed = placed.empty() ? out.scanned : placed;
  out.judged = judged.empty() ? out.scanned : judged;
  return out;
}

Status note_placed(SessionStore& store) {
  return note(store, &MadeBy::placed);
}

Status note_judged(SessionStore& store) {
  return note(store, &MadeBy::judged);
}

}  // namespace dubsar
