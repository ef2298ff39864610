// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "build_paths.h"
#include "drivers/loader.h"
#include "tests/drivers/next_frame.h"
#include "tests/support/peer_process.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {

using Options = std::vector<std::pair<std::string, std::string>>;

/// Whether this process has a network of its own, where emulated cameras do no harm; main() asks for it.
inline bool own_network = false;

/// Rows of a scan: all their numbers, and the last one whole.
struct Rows : ProfileSink {
  bool begin(const ScanInfo& at) override {
    info = at;
    return true;
  }
  bool profile(const Profile& row) override {
    rows.push_back(row.row);
    x.assign(row.x.begin(), row.x.end());
    y.assign(row.y.begin(), row.y.end());
    z.assign(row.z.begin(), row.z.end());
    valid.assign(row.valid.begin(), row.valid.end());
    times.push_back(row.timestamp_ns);
    if (each) {
      each();
    }
    return rows.size() < most;
  }
  void end(const ScanTally& at) override { tally = at; }
  std::function<void()> each;
  std::size_t most = 1U << 30U;
  ScanInfo info;
  std::vector<std::int64_t> rows, times;
  std::vector<float> x, y, z;  ///< of the last row
  std::vector<std::uint8_t> valid;
  std::optional<ScanTally> tally;
};

/// Aravis's fake camera in a process of its own.
class Aravis : public testing::Test {
 protected:
  void SetUp() override {
    if (!own_network) {
      GTEST_SKIP() << "no emulated camera: this kernel gives nobody a network of his own";
    }
    plug_in({});
  }
  void plug_in(std::vector<std::string> words) {
    words.insert(words.begin(), {DUBSAR_BINARY_DIR "/bin/gige_peer", "SN7", folder_.path().string()});
    peer_.emplace(words);
    ASSERT_EQ(peer_->refusal(), "");
  }
  void unplug() {
    ::kill(peer_->pid(), SIGKILL);
    peer_.reset();
  }
  Result<Device> open(const Options& options = {}) {
    return (*registry_.find("aravis"))->open("Dubsar-Range 1-SN7", options);
  }
  static Frame next(Device& device) { return test::next_frame(device); }
  test::TemporaryFolder folder_;
  std::optional<test::PeerProcess> peer_;
  DriverRegistry registry_{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
};

}  // namespace dubsar
