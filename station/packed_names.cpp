// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/packed_names.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>

#include "core/lower_case.h"
#include "formats/sha2.h"

namespace dubsar {

namespace {

constexpr std::size_t kLongest = 64;

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Names that Windows keeps for devices whatever follows their first dot: NUL.ply cannot be opened there.
bool is_device_name(const std::string& stem) {
  const std::string base = in_lower_case(stem.substr(0, stem.find('.')));
  const bool numbered = base.size() == 4 && (base.starts_with("com") || base.starts_with("lpt")) &&
                        base[3] >= '0' && base[3] <= '9';
  return numbered || base == "con" || base == "prn" || base == "aux" || base == "nul";
}

/// Empty where no letter and no digit is in it.
std::string plain_stem(const std::string& name) {
  std::string stem;
  for (const char c : name) {
    if (is_letter_or_digit(c) || c == '-' || (c == '.' && !stem.empty())) {
      stem += c;
    } else if (!stem.empty() && stem.back() != '_') {
      stem += '_';
    }
  }
  while (!stem.empty() && stem.back() == '_') {
    stem.pop_back();
  }
  return stem.substr(0, kLongest);
}

/// Two such names differ in their stems where they differ.
bool is_plain(const std::string& name, bool is_name_of_session) {
  std::string with_blanks = name;
  if (is_name_of_session) {
    std::ranges::replace(with_blanks, '_', ' ');
  }
  std::string stem = plain_stem(name);
  std::ranges::replace(stem, '_', ' ');
  return !stem.empty() && stem == with_blanks && (is_name_of_session || !name.contains('_'));
}

std::string percent_encoded(const std::string& text) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    if (is_letter_or_digit(c) || c == '-' || (c == '.' && !out.empty())) {
      out += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    out += '%';
    out += kHex[byte >> 4U];
    out += kHex[byte & 0xFU];
  }
  return out;
}

std::string document_stem(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return !is_letter_or_digit(c) && c != '-'; }, '_');
  name = name.empty() ? "document" : name.substr(0, kLongest);
  return is_device_name(name) ? "document_" + name : name;
}

}  // namespace

std::string file_stem(const std::string& identifier, const std::string& session) {
  std::string stem = plain_stem(identifier);
  stem = stem.empty() ? plain_stem(session) : stem;
  stem = stem.empty() ? "tablet" : stem;
  return is_device_name(stem) ? "tablet_" + stem : stem;
}

std::string address_name(const std::string& identifier, bool is_name_of_session) {
  constexpr std::size_t kLongestInAddress = 240;
  constexpr std::size_t kDigits = 16;
  const std::string stem = plain_stem(identifier);
  if (is_plain(identifier, is_name_of_session) && !is_device_name(stem)) {
    return stem;
  }
  std::string name = percent_encoded(identifier);
  const bool is_dots =
      identifier.find_first_not_of('.') == std::string::npos;  // the folder above, encoded or not
  if (name.size() <= kLongestInAddress && !is_dots) {
    return name;
  }
  return (stem.empty() ? "tablet" : stem) + "-" + sha256_hex(identifier).substr(0, kDigits);
}

std::vector<std::string> document_files(const std::vector<std::string>& names) {
  std::vector<std::string> files(names.size());
  std::set<std::string> taken{"events"};
  const auto take = [&](std::size_t k, const std::string& stem) {
    if (taken.insert(in_lower_case(stem)).second) {
      files[k] = stem + ".json";
    }
  };
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (document_stem(names[k]) == names[k]) {
      take(k, names[k]);
    }
  }
  std::map<std::string, std::size_t> number;  // of the last one called so
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string stem = document_stem(names[k]);
    while (files[k].empty()) {
      const std::size_t next = ++number[in_lower_case(stem)];
      take(k, next == 1 ? stem : stem + "_" + std::to_string(next));
    }
  }
  return files;
}

}  // namespace dubsar
