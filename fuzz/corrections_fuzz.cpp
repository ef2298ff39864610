// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/corrections_json.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto value = dubsar::parse_corrections(dubsar::fuzz::text_of(data, size), "corrections.json");
  if (!value) {
    return 0;
  }
  for (const dubsar::WedgeCorrection& one : value->corrections) {
    using Kind = dubsar::CorrectionKind;
    dubsar::fuzz::require(one.kind == Kind::kAdd ? !one.region_mm.empty() && one.reach_mm > 0
                                                 : !one.at_mm.empty());
    dubsar::fuzz::require(one.kind != Kind::kSplit || (one.into_mm.size() > 1 && one.at_mm.size() == 1));
    dubsar::fuzz::require(one.kind != Kind::kMerge || one.at_mm.size() > 1);
  }
  const auto again = dubsar::parse_corrections(dubsar::corrections_to_json(*value), "again");
  dubsar::fuzz::require(again && again->corrections.size() == value->corrections.size());
  return 0;
}
