// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/typed_signs.h"

#include <string>
#include <unordered_map>
#include <vector>

#include "core/utf8.h"

namespace dubsar::ui {

namespace {

constexpr std::uint32_t kFirst = 0xAC00;  ///< of the Hangul syllables
constexpr std::uint32_t kCount = 11172;
constexpr std::uint32_t kReplacement = 0xFFFD;

/// What stands in: the k-th of the block for signs[k].
struct StandIns {
  std::vector<std::uint32_t> signs;
  std::unordered_map<std::uint32_t, std::uint32_t> of;
};

StandIns& stand_ins() {
  static StandIns all;
  return all;
}

bool is_stand_in(std::uint32_t sign) {
  return sign >= kFirst && sign < kFirst + kCount;
}

void append(std::uint32_t c, std::string* text) {
  const auto put = [text](std::uint32_t byte) { *text += static_cast<char>(byte); };
  const auto rest = [&](unsigned bits) { put(0x80U | ((c >> bits) & 0x3FU)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0U | (c >> 6U));
    rest(0);
  } else if (c < 0x10000) {
    put(0xE0U | (c >> 12U));
    rest(6);
    rest(0);
  } else {
    put(0xF0U | (c >> 18U));
    rest(12);
    rest(6);
    rest(0);
  }
}

template <class Change>
std::string changed(std::string_view line, const Change& change) {
  std::string out;
  while (!line.empty()) {
    const CodePoint c = first_code_point(line);
    append(change(c.bytes == 0 ? kReplacement : c.value), &out);
    line.remove_prefix(c.bytes == 0 ? 1 : c.bytes);
  }
  return out;
}

}  // namespace

std::uint32_t stand_in_of(std::uint32_t sign) {
  if (sign < 0x10000 && !is_stand_in(sign)) {
    return sign;
  }
  StandIns& all = stand_ins();
  if (const auto known = all.of.find(sign); known != all.of.end()) {
    return known->second;
  }
  if (all.signs.size() == kCount) {
    return kReplacement;
  }
  const std::uint32_t stand_in = kFirst + static_cast<std::uint32_t>(all.signs.size());
  all.signs.push_back(sign);
  all.of.emplace(sign, stand_in);
  return stand_in;
}

std::string stand_ins_of(std::string_view line) {
  return changed(line, stand_in_of);
}

std::string signs_of(std::string_view stand_ins_line) {
  const std::vector<std::uint32_t>& signs = stand_ins().signs;
  return changed(stand_ins_line, [&](std::uint32_t c) {
    return !is_stand_in(c) ? c : c - kFirst < signs.size() ? signs[c - kFirst] : kReplacement;
  });
}

bool can_be_typed_into(std::string_view line) {
  return signs_of(stand_ins_of(line)) == as_utf8(line);
}

}  // namespace dubsar::ui
