// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/rig_limits_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

TEST(RigLimitsJson, ReadsWhatTheDocumentationShows) {
  const auto limits = parse_rig_limits(R"({"unit": "m", "turntable_deg": [-90, 90], "tilt_deg": [0, 50],
      "arm": {"reach": [0.2, 0.9], "height": [0.05, 0.6], "standoff": [0.2, 0.4]},
      "hand_turns": false, "keep_out_margin": 0.025})",
                                       "rig.json");
  ASSERT_TRUE(limits) << limits.error().line();
  EXPECT_DOUBLE_EQ(limits->turntable_rad->low, rad_from_deg(-90));
  EXPECT_DOUBLE_EQ(limits->tilt_rad->high, rad_from_deg(50));
  EXPECT_DOUBLE_EQ(limits->reach_mm->high, 900);
  EXPECT_DOUBLE_EQ(limits->height_mm->low, 50);
  EXPECT_DOUBLE_EQ(limits->standoff_mm->high, 400);
  EXPECT_TRUE(limits->no_hand_turns);
  EXPECT_DOUBLE_EQ(*limits->margin_mm, 25);
  const auto again = parse_rig_limits(rig_limits_to_json(*limits), "again");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(rig_limits_to_json(*again),
            rig_limits_to_json(*parse_rig_limits(rig_limits_to_json(*again), "")));
}

TEST(RigLimitsJson, WhatIsNotSaidIsNotLimited) {
  const auto limits = parse_rig_limits(R"({"tilt_deg": [0, 50]})", "rig.json");
  ASSERT_TRUE(limits);
  EXPECT_FALSE(limits->turntable_rad || limits->reach_mm || limits->no_hand_turns || limits->margin_mm);
}

TEST(RigLimitsJson, RefusesWhatWouldNotHold) {
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {R"({"tilt": [0, 50]})", "has 'tilt', and knows unit, turntable_deg"},
           {R"({"arm": {"stand_off": [0, 50]}})", "arm has 'stand_off'"},
           {R"({"tilt_deg": [50, 0]})", "tilt_deg goes from more to less"},
           {R"({"tilt_deg": [0]})", "tilt_deg"},
           {R"({"tilt_deg": 50})", "tilt_deg"},
           {R"({"tilt_deg": [0, 1e300]})", "out of all reason"},
           {R"({"keep_out_margin": -3})", "keep_out_margin"},
           {R"({"hand_turns": "no"})", "hand_turns"},
           {R"({"unit": "ell"})", "unit"},
           {"[1, 2]", "document"},
           {"", "empty"}}) {
    const auto limits = parse_rig_limits(text, "rig.json");
    ASSERT_FALSE(limits) << text;
    EXPECT_EQ(limits.error().kind, ErrorKind::kBadInput) << text;
    EXPECT_THAT(limits.error().line(), HasSubstr(says)) << text;
    EXPECT_THAT(limits.error().line(), HasSubstr("rig.json")) << text;
  }
}

}  // namespace
}  // namespace dubsar
