// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/alike_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace dubsar {

namespace {

constexpr const char* kNumber = "0123456789.-+e";

std::string without_numbers(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] < '0' || text[at] > '9') {
      out += text[at++];
      continue;
    }
    at = std::min(text.find_first_not_of(kNumber, at), text.size());
    out += '0';
  }
  return out;
}

}  // namespace

std::string AlikeRemarks::add(const std::string& file, const std::string& remark) {
  Alike& alike = alike_[without_numbers(remark)];
  if (alike.file.empty()) {
    alike.file = file;
    return file + ": " + remark;
  }
  if (alike.others.empty()) {
    alike.second = remark;
  }
  alike.others.push_back(file);
  return {};
}

std::vector<std::string> AlikeRemarks::rest() const {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> out;
  for (const auto& [text, alike] : alike_) {
    if (alike.others.size() == 1) {
      out.push_back(alike.others.front() + ": " + alike.second);
    } else if (!alike.others.empty()) {
      std::string names;
      const std::size_t said = std::min(alike.others.size(), kMost);
      for (std::size_t k = 0; k < said; ++k) {
        names += (k == 0 ? "" : k + 1 == alike.others.size() ? " and " : ", ") + alike.others[k];
      }
      const std::size_t more = alike.others.size() - said;
      names += more > 0 ? fmt::format(" and {} more", more) : "";
      out.push_back(
          fmt::format("what is said of {} is so of {} others: {}", alike.file, alike.others.size(), names));
    }
  }
  return out;
}

}  // namespace dubsar
