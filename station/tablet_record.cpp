// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_record.h"

#include <algorithm>
#include <utility>

#include "core/utf8.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

constexpr const char* kDocument = "tablet";
constexpr std::size_t kMostBytesOfALine = 1000, kMostBytesOfNotes = 100'000;

/// What heads pages, names files and is printed everywhere is no place for a text.
Status check_texts(const TabletRecord& record) {
  for (const auto& [what, text] :
       {std::pair{"the museum number", &record.museum_number},
        std::pair{"the collection", &record.collection}, std::pair{"the operator", &record.operator_name},
        std::pair{"the rights", &record.rights}, std::pair{"the notes", &record.notes}}) {
    if (!is_utf8(*text)) {
      return fail(ErrorKind::kUsage, "it has bytes that are no UTF-8", what,
                  "set the terminal to UTF-8, and say it again");
    }
    if (text == &record.notes && text->size() > kMostBytesOfNotes) {
      return fail(ErrorKind::kUsage, "more than 100 000 bytes", what, "say less");
    }
    if (text != &record.notes && text->size() > kMostBytesOfALine) {
      return fail(ErrorKind::kUsage, "more than 1000 bytes", what, "say less");
    }
  }
  return {};
}

}  // namespace

Status check_cdli(std::string_view number) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (number.empty() ||
      (number.size() == 7 && number.front() == 'P' && std::ranges::all_of(number.substr(1), digit))) {
    return {};
  }
  return fail(ErrorKind::kUsage, "this is no CDLI number", std::string(number),
              "it is a P and six digits, such as P123456");
}

std::vector<std::pair<std::string, std::string>> words_of(const TabletRecord& record) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const auto& [name, value] :
       {std::pair{"Museum number", record.museum_number}, std::pair{"CDLI number", record.cdli},
        std::pair{"Collection", record.collection}, std::pair{"Scanned by", record.operator_name},
        std::pair{"Rights", record.rights}, std::pair{"Notes", record.notes}}) {
    if (!value.empty()) {
      words.emplace_back(name, value);
    }
  }
  return words;
}

std::string tablet_record_to_json(const TabletRecord& record) {
  return text_of({{"museum_number", record.museum_number},
                  {"cdli", record.cdli},
                  {"collection", record.collection},
                  {"operator", record.operator_name},
                  {"rights", record.rights},
                  {"notes", record.notes}});
}

Result<TabletRecord> parse_tablet_record(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  TabletRecord record;
  const auto take = [&](const char* key, std::string& into) {
    if (const auto node = document->root().find(key)) {
      into = trimmed(node->text());
    }
  };
  take("museum_number", record.museum_number);
  take("cdli", record.cdli);
  take("collection", record.collection);
  take("operator", record.operator_name);
  take("rights", record.rights);
  take("notes", record.notes);
  if (const Status status = document->status("say anew what tablet it is"); !status) {
    return std::unexpected(status.error());
  }
  return record;
}

Status keep_tablet_record(SessionStore& store, const TabletRecord& said) {
  TabletRecord record = said;
  for (const auto field : {&TabletRecord::museum_number, &TabletRecord::cdli, &TabletRecord::collection,
                           &TabletRecord::operator_name, &TabletRecord::rights, &TabletRecord::notes}) {
    record.*field = std::string(trimmed(record.*field));
  }
  if (const Status checked = check_cdli(record.cdli); !checked) {
    return checked;
  }
  if (const Status fits = check_texts(record); !fits) {
    return fits;
  }
  const bool says_more = record != tablet_record_of(store);
  const std::string text = tablet_record_to_json(record);
  if (const Status saved = store.save_document(kDocument, text); !saved || !says_more) {
    return saved;
  }
  return store.append_event("tablet described", text);
}

TabletRecord tablet_record_of(const SessionStore& store) {
  const auto text = store.load_document(kDocument);
  if (text && *text) {
    if (auto record = parse_tablet_record(**text, "tablet of the session")) {
      return std::move(*record);
    }
  }
  return {};
}

}  // namespace dubsar
