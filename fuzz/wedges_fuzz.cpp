// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/wedges_json.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // What was read once must be written so that it can be read again.
  if (const auto value = dubsar::parse_wedges(dubsar::fuzz::text_of(data, size), "wedges.json")) {
    dubsar::fuzz::require(dubsar::parse_wedges(dubsar::wedges_to_json(*value), "again").has_value());
  }
  return 0;
}
