// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rights.h"

#include <algorithm>
#include <array>
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
  address.resize(std::min(address.find_first_of("?#"), address.size()));
  if (address.starts_with("https")) {
    address.erase(4, 1);
  }
  constexpr std::string_view kPage = "http://rightsstatements.org/page/";
  constexpr std::string_view kStatement = "http://rightsstatements.org/vocab/";
  if (address.starts_with(kPage)) {
    address.replace(0, kPage.size(), kStatement);
  }
  // Browsers show the page that tells people of a licence: its own address is the folder of that.
  const std::size_t page = address.rfind('/') + 1;
  for (const std::string_view told_by : {"deed", "legalcode"}) {
    const std::string_view last = std::string_view(address).substr(page);
    if (last == told_by || (last.starts_with(told_by) && last[told_by.size()] == '.')) {
      address.resize(page);
    }
  }
  if (!address.ends_with('/')) {
    address += '/';
  }
  const bool known = std::ranges::any_of(
      std::array<std::string_view, 3>{"http://creativecommons.org/licenses/",
                                      "http://creativecommons.org/publicdomain/", kStatement},
      [&](std::string_view of) { return address.starts_with(of) && address.size() > of.size(); });
  return known ? address : std::string();
}

}  // namespace dubsar
