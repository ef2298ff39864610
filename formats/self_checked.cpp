// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/self_checked.h"

#include <algorithm>
#include <ranges>

#include "formats/xxh128.h"

namespace dubsar {

namespace {

constexpr std::string_view kBefore = ",\"xxh128\":\"";
constexpr std::string_view kAfter = "\"}";
constexpr std::size_t kDigits = 32;

constexpr std::size_t kSize = kBefore.size() + kDigits + kAfter.size();
/// A text with no checksum differs from the form of one in a dozen places.
constexpr std::ptrdiff_t kDamaged = 6;

std::string_view without_line_end(std::string_view text) {
  while (text.ends_with('\n') || text.ends_with('\r')) {
    text.remove_suffix(1);
  }
  return text;
}

/// In how many of its last bytes a text differs from the form of a checksum, whatever its digits are.
std::ptrdiff_t differences(std::string_view text) {
  if (text.size() < kSize) {
    return static_cast<std::ptrdiff_t>(kSize);
  }
  const std::string_view tail = text.substr(text.size() - kSize);
  const auto unlike = [&](std::string_view part, std::size_t at) {
    return std::ranges::count_if(std::views::iota(std::size_t{0}, part.size()),
                                 [&](std::size_t i) { return tail[at + i] != part[i]; });
  };
  const auto is_no_digit = [](char c) { return !((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')); };
  return unlike(kBefore, 0) + std::ranges::count_if(tail.substr(kBefore.size(), kDigits), is_no_digit) +
         unlike(kAfter, kSize - kAfter.size());
}

/// Whether there was one once: damage to the checksum itself must not pass for a file that never had one.
bool had_one(std::string_view text) {
  for (const std::size_t line_end : {0, 1, 2}) {
    if (text.size() > line_end && differences(text.substr(0, text.size() - line_end)) <= kDamaged) {
      return true;
    }
  }
  // The end was cut off, or something came between.
  return text.substr(text.size() - std::min(text.size(), 2 * kSize)).find(kBefore) != std::string_view::npos;
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
  const std::string_view object = without_line_end(text);
  if (differences(object) > 0) {
    return had_one(text) ? OwnChecksum::kFails : OwnChecksum::kNone;
  }
  const std::string_view sum = object.substr(object.size() - kAfter.size() - kDigits, kDigits);
  return sum == xxh128_hex(object.substr(0, object.size() - kSize)) ? OwnChecksum::kFits
                                                                    : OwnChecksum::kFails;
}

Result<JsonDocument> parse_self_checked(std::string_view text, const std::string& where) {
  if (own_checksum_of(text) == OwnChecksum::kFails) {
    return fail(ErrorKind::kBadInput, "its checksum does not fit: damaged, or edited by hand", where,
                "bring a copy back; after an edit that you mean take the last member, \"xxh128\", out");
  }
  return JsonDocument::parse(text, where);
}

}  // namespace dubsar
