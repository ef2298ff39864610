// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/sign_off_json.h"

#include <limits>

#include "formats/json_node.h"

namespace dubsar {

OrderedJson sign_off_json(const SignOff& sign_off) {
  OrderedJson json{{"number", sign_off.number},   {"name", sign_off.name},
                   {"role", sign_off.role},       {"note", sign_off.note},
                   {"when", sign_off.when},       {"conclusive", sign_off.conclusive},
                   {"program", sign_off.program}, {"sha256", sign_off.digest}};
  if (!sign_off.incomplete.empty()) {
    json["incomplete"] = sign_off.incomplete;
  }
  return json;
}

OrderedJson sign_off_json(const CheckedSignOff& checked) {
  OrderedJson json = sign_off_json(checked.sign_off);
  json["holds"] = checked.holds();
  json["changed"] = checked.changed;
  return json;
}

std::string recorded_sign_off_to_json(const RecordedSignOff& recorded) {
  OrderedJson json = sign_off_json(recorded.sign_off);
  json["manifest"] = recorded.manifest;
  return text_of(json);
}

Result<RecordedSignOff> parse_recorded_sign_off(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  RecordedSignOff out;
  SignOff& s = out.sign_off;
  s.number = static_cast<int>(root.at("number").integer(1, std::numeric_limits<int>::max()));
  s.name = root.at("name").text();
  s.role = root.at("role").text();
  s.note = root.at("note").text();
  s.when = root.at("when").text();
  s.conclusive = root.at("conclusive").boolean();
  s.program = root.at("program").text();
  s.digest = root.at("sha256").text();
  if (const auto reason = root.find("incomplete")) {
    s.incomplete = reason->text();
  }
  out.manifest = root.at("manifest").text();
  if (Status status = document->status("sign the session again"); !status) {
    return std::unexpected(status.error());
  }
  return out;
}

}  // namespace dubsar
