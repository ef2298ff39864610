// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// RFC 3986, 2.1 and 2.3.
#include "archive/file_address.h"

#include <cstddef>

namespace dubsar {

namespace {

constexpr std::string_view kHex = "0123456789ABCDEF";

bool stays(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~/").contains(c);
}

}  // namespace

std::string path_in_address(std::string_view path) {
  std::string out;
  for (const char c : path) {
    if (stays(c)) {
      out.push_back(c);
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    out.push_back('%');
    out.push_back(kHex[byte >> 4U]);
    out.push_back(kHex[byte & 0xFU]);
  }
  return out;
}

std::string path_of_address(std::string_view address) {
  std::string out;
  for (std::size_t i = 0; i < address.size(); ++i) {
    const bool encoded = address[i] == '%' && i + 2 < address.size();
    const std::size_t high = encoded ? kHex.find(address[i + 1]) : std::string_view::npos;
    const std::size_t low = encoded ? kHex.find(address[i + 2]) : std::string_view::npos;
    if (high == std::string_view::npos || low == std::string_view::npos) {
      out.push_back(address[i]);
    } else {
      out.push_back(static_cast<char>(16 * high + low));
      i += 2;
    }
  }
  return out;
}

}  // namespace dubsar
