// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/hint_json.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = dubsar::fuzz::text_of(data, size);
  if (auto file = dubsar::parse_hint(text, "hint.json"); file && !file->model_from_scanner) {
    file->hint.on = file->hint.on < 0 ? 0 : file->hint.on;
    dubsar::fuzz::require(dubsar::parse_hint(dubsar::hint_to_json(file->hint), "again").has_value());
  }
  if (const auto pair = dubsar::parse_point_pair(text)) {
    dubsar::fuzz::require(pair->point_mm.allFinite() && pair->on_point_mm.allFinite());
  }
  if (const auto pose = dubsar::parse_pose_numbers(text, "numbers")) {
    dubsar::fuzz::require(pose->is_rigid(1e-9));
  }
  return 0;
}
