// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/selections_json.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto value = dubsar::parse_selections(dubsar::fuzz::text_of(data, size), "selections.json");
  if (!value) {
    return 0;
  }
  for (const dubsar::MeshSelection& selection : value->selections) {
    std::uint64_t end = 0;
    for (const dubsar::IndexRange& range : selection.ranges) {
      dubsar::fuzz::require(range.count > 0 && range.first >= end);
      end = std::uint64_t{range.first} + range.count;
      dubsar::fuzz::require(end <= std::uint64_t{1} << 32U);
    }
  }
  const auto again = dubsar::parse_selections(dubsar::selections_to_json(*value), "again");
  dubsar::fuzz::require(again && again->selections == value->selections);
  return 0;
}
