// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/states_ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/byte_order.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

TEST(StatesPly, HasPlaceColourStateScanAndReasonOfEachSample) {
  RangeGrid grid;
  grid.allocate(2, 2);
  grid.source = "scan\n7.ply";
  for (std::size_t i = 0; i < 3; ++i) {
    grid.valid[i] = 1;
    grid.x[i] = static_cast<float>(i);
  }
  SampleStates states;
  states.state = {SampleState::kSampled, SampleState::kCleared, SampleState::kUnreachable,
                  SampleState::kNone};
  states.cleared_by = {-1, 12, -1, -1};
  states.reason = {-1, -1, 0, -1};
  states.reasons = {"too deep"};
  RigidTransform pose;
  pose.translation_mm = {0, 0, 5};
  const std::string bytes = encode_states_ply(7, grid, pose, states);
  const std::size_t end = bytes.find("end_header\n") + 11;
  const std::string header = bytes.substr(0, end);
  EXPECT_THAT(header, HasSubstr("obj_info scan 7\nobj_info num_cols 2\nobj_info num_rows 2\n"));
  EXPECT_THAT(header, HasSubstr("obj_info file scan 7.ply\n")) << "one line";
  EXPECT_THAT(header, HasSubstr("obj_info state 3 cleared 1\n"));
  EXPECT_THAT(header, HasSubstr("obj_info reason 0 too deep\n"));
  EXPECT_THAT(header, HasSubstr("element vertex 3\n"));
  constexpr std::size_t kVertex = 3 * 4 + 3 + 1 + 2 + 2 + 4;
  ASSERT_EQ(bytes.size(), end + 3 * kVertex);
  const char* second = bytes.data() + end + kVertex;
  EXPECT_EQ(load<float>(second), 1.0F);
  EXPECT_EQ(load<float>(second + 8), 5.0F) << "in the model frame";
  EXPECT_EQ(load<std::uint8_t>(second + 15), 3);
  EXPECT_EQ(load<std::int16_t>(second + 16), 12);
  EXPECT_EQ(load<std::int16_t>(second + 18), -1);
  EXPECT_EQ(load<std::int32_t>(second + 20), 1);
  EXPECT_EQ(load<std::int16_t>(second + kVertex + 18), 0);
}

}  // namespace
}  // namespace dubsar
