// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bytes_left_over.h"

namespace dubsar {

std::string bytes_left_over(std::string_view rest) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  const std::size_t first = rest.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  const std::size_t count = rest.find_last_not_of(kBlanks) + 1 - first;
  return std::to_string(count) +
         " bytes follow what the header tells of and are passed over; export it again if something is "
         "missing";
}

}  // namespace dubsar
