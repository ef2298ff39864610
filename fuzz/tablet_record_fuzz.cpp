// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "fuzz/fuzz_support.h"
#include "station/tablet_record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // What was read once must be written so that it can be read again.
  if (const auto value = dubsar::parse_tablet_record(dubsar::fuzz::text_of(data, size), "tablet")) {
    const auto again = dubsar::parse_tablet_record(dubsar::tablet_record_to_json(*value), "again");
    dubsar::fuzz::require(again.has_value());
  }
  return 0;
}
