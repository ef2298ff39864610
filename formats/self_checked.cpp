// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/self_checked.h"

#include "formats/xxh128.h"

namespace dubsar {

namespace {

constexpr std::string_view kBefore = ",\"xxh128\":\"";
constexpr std::string_view kAfter = "\"}";
constexpr std::size_t kDigits = 32;

std::string_view without_line_end(std::string_view text) {
  while (text.ends_with('\n') || text.ends_with('\r')) {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace

std::string with_own_checksum(std::string json) {
  json.resize(without_line_end(json).size());
  json.pop_back();  // the brace
  const std::string sum = xxh128_hex(json);
  json += kBefore;
  json += sum;
  json += kAfter;
  return json + "\n";
}

OwnChecksum own_checksum_of(std::string_view text) {
  constexpr std::size_t kSize = kBefore.size() + kDigits + kAfter.size();
  text = without_line_end(text);
  if (text.size() < kSize || !text.ends_with(kAfter) ||
      text.substr(text.size() - kSize, kBefore.size()) != kBefore) {
    return OwnChecksum::kNone;
  }
  const std::string_view sum = text.substr(text.size() - kAfter.size() - kDigits, kDigits);
  return sum == xxh128_hex(text.substr(0, text.size() - kSize)) ? OwnChecksum::kFits : OwnChecksum::kFails;
}

Status check_own_checksum(std::string_view text, const std::string& where) {
  if (own_checksum_of(text) == OwnChecksum::kFails) {
    return fail(ErrorKind::kBadInput, "its checksum does not fit: damaged, or edited by hand", where,
                "bring a copy back; after an edit that you mean take the last member, \"xxh128\", out");
  }
  return {};
}

}  // namespace dubsar
