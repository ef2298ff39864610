// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The aravis: driver with a GigE Vision device of our own, which can lose packets, send them again, and obeys
// one program at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/aravis_fixture.h"

namespace dubsar {
namespace {

/// A device of our own that loses packets, and sends them again.
class Resending : public Aravis {
 protected:
  void SetUp() override {
    if (!own_network) {
      GTEST_SKIP() << "no emulated camera: this kernel gives nobody a network of his own";
    }
    peer_.emplace(std::vector<std::string>{DUBSAR_BINARY_DIR "/bin/resending_peer", "SN7", "0.02"});
    ASSERT_EQ(peer_->refusal(), "");
  }
  Result<Device> open_with(Options options) {
    options.insert(options.end(), {{"rows", "2000"}, {"packet", "1400"}, {"raw_socket", "0"}});
    return (*registry_.find("aravis"))->open("Dubsar-Resender-SN7", options);
  }
};

TEST_F(Resending, LostPacketsAreAskedForAgainAndEachRowKnowsItsEncoder) {
  Device device = open_with({{"count", "0.5"}, {"row", "0.125"}}).value();
  struct : Rows {
    bool profile(const Profile& row) override {
      encoders.push_back(row.encoder.value_or(-1));
      ys.push_back(row.y.front());
      return Rows::profile(row);
    }
    std::vector<std::int64_t> encoders;
    std::vector<float> ys;
  } rows;
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(rows.rows.size(), 2000U);
  EXPECT_EQ(rows.tally->profiles_dropped, 0U);
  EXPECT_GT(std::stoi(peer_->tell("resent")), 0);
  EXPECT_GT(device.frame_counters()->resent, 0U);
  EXPECT_FLOAT_EQ(rows.z[100], 130);
  for (std::size_t k = 0; k < 2000; k += 37) {
    const auto block = static_cast<std::int64_t>(k / 40);
    EXPECT_EQ(rows.encoders[k], rows.encoders[0] + 10 * block);
    EXPECT_FLOAT_EQ(rows.ys[k], static_cast<float>(5 * block) + 0.125F * static_cast<float>(k % 40));
  }
}

TEST_F(Resending, WithoutResendTheSameLossLeavesGaps) {
  Device device = open_with({{"resend", "0"}}).value();
  Rows rows;
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_GT(rows.tally->profiles_dropped, 0U);
  EXPECT_EQ(peer_->tell("resent"), "0");
}

/// So does one that heard nothing for too long: the cable was out, or this machine slept, between two scans.
TEST_F(Resending, ACameraThatForgotWhoHasControlIsTakenAnew) {
  Device device = open_with({}).value();
  for (int round = 0; round < 2; ++round) {
    Rows rows;
    rows.most = 80;
    const auto scanned = device.scan(rows);
    ASSERT_FALSE(scanned);
    EXPECT_EQ(scanned.error().kind, ErrorKind::kCancelled) << scanned.error().line();
    EXPECT_EQ(rows.rows.size(), 80U);
    ASSERT_EQ(peer_->tell("forget"), "ok");
  }
}

TEST_F(Resending, OneProgramAtATimeHasTheCamera) {
  const Device device = open_with({}).value();
  const auto other = open_with({});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(other.error().line(), testing::HasSubstr("in use by another program"));
}

TEST_F(Resending, ACameraThatFallsSilentIsTold) {
  Device device = open_with({}).value();
  Rows rows;
  rows.each = [&] {
    if (rows.rows.size() == 80) {
      EXPECT_EQ(peer_->tell("quiet"), "ok");
    }
  };
  const auto outcome = device.scan(rows);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_GE(rows.rows.size(), 80U);
}

}  // namespace
}  // namespace dubsar
