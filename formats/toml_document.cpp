// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/toml_document.h"

#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#include <sstream>
#include <toml++/toml.h>

namespace dubsar {

Result<JsonDocument> parse_toml(std::string_view text, const std::string& where) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  constexpr const char* kMend = "write it as TOML: name = value, [table], [[list of tables]]";
  if (text.size() > kMostBytes) {
    return bad_input(where, "this file is far too large for a few settings", kMend);
  }
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return bad_input(where,
                     "line " + std::to_string(error.source().begin.line) + ": " + std::string(error.description()),
                     kMend);
  }
  std::ostringstream json;
  json << toml::json_formatter(parsed.table());
  return JsonDocument::parse(json.str(), where);
}

}  // namespace dubsar
