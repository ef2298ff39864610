// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/motion_limits.h"
#include "formats/rig_json.h"
#include "formats/rig_limits_json.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = dubsar::fuzz::text_of(data, size);
  if (const auto limits = dubsar::parse_rig_limits(text, "rig.json")) {
    dubsar::fuzz::require(dubsar::parse_rig_limits(dubsar::rig_limits_to_json(*limits), "again").has_value());
    dubsar::Rig rig;
    rig.has_turntable = true;
    rig.tilt_max_rad = 1;
    rig.robot = dubsar::RobotReach{};
    if (const auto narrow = dubsar::narrowed(rig, *limits, "rig.json")) {
      // Whatever the file says, it never widens.
      dubsar::fuzz::require(narrow->tilt_min_rad >= rig.tilt_min_rad &&
                            narrow->tilt_max_rad <= rig.tilt_max_rad);
      dubsar::fuzz::require(narrow->robot->reach_mm.low >= rig.robot->reach_mm.low &&
                            narrow->robot->reach_mm.high <= rig.robot->reach_mm.high);
      dubsar::fuzz::require(narrow->keep_out_margin_mm >= rig.keep_out_margin_mm);
    }
  }
  if (const auto rig = dubsar::parse_rig(text, "rig")) {
    dubsar::fuzz::require(dubsar::parse_rig(dubsar::rig_to_json(*rig), "again").has_value());
  }
  return 0;
}
