// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The aravis: driver with a GigE Vision device of our own, which can lose packets, send them again, and obeys
// one program at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "build_paths.h"
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
    options.insert(options.end(), {{"packet", "1400"}, {"raw_socket", "0"}});
    if (std::ranges::find(options, "rows", &Options::value_type::first) == options.end()) {
      options.emplace_back("rows", "2000");
    }
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

/// It may have a laser of its own, which then burns on.
TEST_F(Resending, ACameraThatDoesNotEndItsStreamIsTold) {
  Device device = open_with({{"rows", "400"}}).value();
  EXPECT_TRUE(device.stop());
  ASSERT_EQ(peer_->tell("burn on"), "ok");
  for (const bool to_its_end : {true, false}) {
    Rows rows;
    rows.most = to_its_end ? 1000 : 80;
    const auto scanned = device.scan(rows);
    ASSERT_FALSE(scanned);
    EXPECT_EQ(scanned.error().kind, to_its_end ? ErrorKind::kDevice : ErrorKind::kCancelled);
    const Status stopped = device.stop();
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kDevice);
    EXPECT_NE(stopped.error().line().find("does not end its stream"), std::string::npos)
        << stopped.error().line();
    EXPECT_TRUE(!to_its_end || scanned.error().what == stopped.error().what) << scanned.error().what;
  }
  ASSERT_EQ(peer_->tell("obey"), "ok");
  Rows rows;
  const auto scanned = device.scan(rows);
  EXPECT_TRUE(scanned) << scanned.error().line();
  EXPECT_TRUE(device.stop());
}

TEST_F(Resending, ACameraThatIsLostWithItsStreamRunningHasNotStopped) {
  Device device = open_with({{"rows", "24000"}}).value();
  Rows rows;
  rows.each = [&] { rows.rows.size() == 100 ? void(peer_->tell("quiet")) : void(); };
  ASSERT_FALSE(device.scan(rows));
  const Status stopped = device.stop();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kDevice);
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

/// Rows among which the camera is told something once.
struct Interrupted : Rows {
  Interrupted(test::PeerProcess& camera, std::string word) {
    each = [this, &camera, word = std::move(word)] {
      if (rows.size() == 400) {
        EXPECT_EQ(camera.tell(word), "ok");
      }
    };
  }
  bool profile(const Profile& row) override {
    encoders.push_back(row.encoder.value_or(-1));
    return Rows::profile(row);
  }
  /// The widest gap between the rows, from the row before it.
  [[nodiscard]] std::pair<std::size_t, std::int64_t> gap() const {
    std::pair<std::size_t, std::int64_t> out{};
    for (std::size_t k = 1; k < rows.size(); ++k) {
      out = rows[k] - rows[k - 1] > out.second ? std::pair(k - 1, rows[k] - rows[k - 1]) : out;
    }
    return out;
  }
  std::vector<std::int64_t> encoders;
};

/// A number that went wrong, or a network that was away: a few rows are no scan.
TEST_F(Resending, AJumpToTheEndOfTheScanIsAnError) {
  Device device = open_with({{"rows", "4000"}}).value();
  Interrupted rows(*peer_, "skip 1000");
  const auto outcome = device.scan(rows);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(outcome.error().line(), testing::HasSubstr("frames in a row, and most of the scan with them"));
  EXPECT_GE(rows.rows.size(), 400U);
  EXPECT_LT(rows.rows.size(), 2000U);
  ASSERT_TRUE(rows.tally);
  EXPECT_EQ(rows.rows.size() + rows.tally->profiles_dropped, 4000U);
}

/// A heartbeat was missed, by the network or by this machine: the camera is there, and obeys nobody.
TEST_F(Resending, ControlThatIsLostInMidScanIsTakenAgainAndTheRowsInBetweenAreCounted) {
  Device device = open_with({{"rows", "24000"}}).value();
  ASSERT_TRUE(device.set("light", std::int64_t{55}));
  Interrupted rows(*peer_, "forget");
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  ASSERT_TRUE(rows.tally);
  EXPECT_EQ(rows.rows.back(), 23999);
  EXPECT_EQ(rows.rows.size() + rows.tally->profiles_dropped, 24000U);
  const auto [before, missed] = rows.gap();
  EXPECT_GE(before, 399U);
  // 5000 rows a second, in blocks of 40: as many as fell into the time are missing.
  const double seconds = 1e-9 * static_cast<double>(rows.times[before + 1] - rows.times[before]);
  EXPECT_NEAR(static_cast<double>(missed), 5000 * seconds, 80);
  EXPECT_EQ(std::get<std::int64_t>(device.get("light").value()), 55);
  EXPECT_EQ(device.frame_counters()->reconnections, 1U);
}

/// Aravis asks for its control once a second, which is later than a short wait for profiles ends.
TEST_F(Resending, ControlThatIsLostIsNoSilenceHoweverShortTheWait) {
  Device device = open_with({{"rows", "24000"}, {"wait", "0.5"}}).value();
  Interrupted rows(*peer_, "forget");
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(rows.rows.back(), 23999);
}

/// What is left of the connection before ends the stream of its address, and is in no hurry.
TEST_F(Resending, TheEndOfTheOldConnectionDoesNotEndTheNewOne) {
  Device device = open_with({{"rows", "24000"}}).value();
  ASSERT_EQ(peer_->tell("lax"), "ok");
  Interrupted rows(*peer_, "forget");
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(rows.rows.back(), 23999);
}

TEST_F(Resending, ACameraThatStartsAnewInMidScanGoesOn) {
  Device device = open_with({{"rows", "24000"}}).value();
  Interrupted rows(*peer_, "restart");
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(rows.rows.back(), 23999);
  EXPECT_EQ(rows.rows.size() + rows.tally->profiles_dropped, 24000U);
  EXPECT_GT(rows.tally->profiles_dropped, 0U);
  EXPECT_TRUE(std::ranges::is_sorted(rows.times));  // its clock began at nought
}

/// A region that does not begin at the sensor's corner has to be made narrow before it is put aside.
TEST_F(Resending, ACameraThatStartsAnewHasItsRegionSetInTheOrderThatItTakes) {
  Device device = open_with({{"rows", "24000"}}).value();
  EXPECT_FALSE(device.set("offset_x_px", std::int64_t{100}));
  ASSERT_TRUE(device.set("width_px", std::int64_t{200}));
  ASSERT_TRUE(device.set("offset_x_px", std::int64_t{100}));
  Interrupted rows(*peer_, "restart");
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(rows.x.size(), 200U);
  EXPECT_EQ(std::get<std::int64_t>(device.get("offset_x_px").value()), 100);
}

/// Rows that an encoder places go nowhere without its count.
TEST_F(Resending, ACameraThatStartsAnewWithItsEncoderEndsTheScan) {
  Device device = open_with({{"rows", "24000"}, {"count", "0.5"}, {"row", "0.125"}}).value();
  Interrupted rows(*peer_, "restart");
  const auto outcome = device.scan(rows);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(outcome.error().line(), testing::HasSubstr("its encoder counts from elsewhere"));
  EXPECT_GE(rows.rows.size(), 400U);
  EXPECT_TRUE(std::ranges::is_sorted(rows.encoders));
  ASSERT_TRUE(rows.tally);
  Rows again;
  again.most = 80;
  EXPECT_EQ(device.scan(again).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(again.rows.size(), 80U);
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

/// It lets go of this program, is taken again, and dies of that: Aravis would wait for its answers for
/// seconds.
TEST_F(Resending, ACameraThatDiesWhileItIsTakenAgainIsToldAsSoonAsAnyOther) {
  Device device = open_with({{"rows", "24000"}}).value();
  Interrupted rows(*peer_, "forget and die when taken");
  const auto outcome = device.scan(rows);
  const int silent_ms = std::stoi(peer_->tell("silent ms"));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_GE(rows.rows.size(), 400U);
  EXPECT_GT(silent_ms, 0) << "it was not taken again";
  EXPECT_LT(silent_ms, 8000) << "on a busy machine; Aravis alone would wait for 32 s";
}

}  // namespace
}  // namespace dubsar
