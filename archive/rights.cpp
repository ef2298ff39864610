// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rights.h"

#include <algorithm>
#include <string_view>

namespace dubsar {

std::string rights_address(std::string_view rights) {
  std::size_t at = std::min(rights.find("https://"), rights.find("http://"));
  if (at == std::string_view::npos) {
    return {};
  }
  std::string_view address = rights.substr(at);
  address = address.substr(0, address.find_first_of(" \t\r\n<>\"'`{}|\\^)];"));
  while (!address.empty() && std::string_view(".,:!?").contains(address.back())) {
    address.remove_suffix(1);  // the sentence's, not the address's
  }
  return address.ends_with("://") ? std::string() : std::string(address);
}

std::string iiif_rights(std::string_view rights) {
  std::string address = rights_address(rights);
  if (address.starts_with("https")) {
    address.erase(4, 1);
  }
  const bool known = address.starts_with("http://creativecommons.org/") ||
                     address.starts_with("http://rightsstatements.org/");
  return known ? address : std::string();
}

}  // namespace dubsar
