// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "fuzz/fuzz_support.h"
#include "station/done_stamp.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // What was read once must be written so that it can be read again.
  if (const auto stamp = dubsar::parse_done_stamp(dubsar::fuzz::text_of(data, size), "wedges.json.done")) {
    dubsar::fuzz::require(dubsar::parse_done_stamp(dubsar::done_stamp_to_json(*stamp), "again").has_value());
  }
  return 0;
}
